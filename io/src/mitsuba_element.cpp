// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_element.h"

#include <cctype>

#include "core/error.h"

namespace vrc {

const std::string* XmlElement::find(std::string_view attribute) const {
  for (const auto& [name, value] : attributes) {
    if (name == attribute) return &value;
  }
  return nullptr;
}

std::string_view XmlElement::get(std::string_view attribute) const {
  const std::string* value = find(attribute);
  return value == nullptr ? std::string_view() : std::string_view(*value);
}

std::string XmlElement::label() const {
  std::string text = "<" + tag;
  for (const char* attribute : {"type", "name", "id"}) {
    if (const std::string* value = find(attribute)) text += fmt::format(" {}=\"{}\"", attribute, *value);
  }
  return text + ">";
}

void fail(const XmlElement& element, const std::string& problem) {
  throw InputError(element.file, element.line, fmt::format("{}: {}", element.label(), problem));
}

void MitsubaReport::reject(const XmlElement& element, const std::string& problem, std::string_view action) {
  if (!lenient_) fail(element, problem);
  warn(element, fmt::format("{} ({})", problem, action));
}

void MitsubaReport::warn(const XmlElement& element, const std::string& problem) {
  warnings_.push_back(fmt::format("{}:{}: {}: {}", element.file, element.line, element.label(), problem));
}

std::filesystem::path resolve_file(const XmlElement& element, const std::string& name,
                                   const std::vector<std::filesystem::path>& folders) {
  std::vector<std::filesystem::path> candidates = {std::filesystem::path(element.file).parent_path() / name};
  for (const std::filesystem::path& folder : folders) candidates.push_back(folder / name);
  for (const std::filesystem::path& candidate : candidates) {
    if (std::filesystem::is_regular_file(candidate)) return candidate;
  }
  fail(element, fmt::format("there is no file '{}'; looked for '{}' and in the <path> folders", name,
                            candidates.front().string()));
}

std::string to_snake_case(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    const bool is_upper = std::isupper(c) != 0;
    if (is_upper && i > 0 && std::islower(static_cast<unsigned char>(name[i - 1])) != 0) result += '_';
    result += static_cast<char>(std::tolower(c));
  }
  return result;
}

}  // namespace vrc
