// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli_values.h"

#include "shading/render.h"

namespace vrc {
namespace {

constexpr NumberRange<int> kPixels{1, 16384};
constexpr NumberRange<double> kCoordinates{-1e12, 1e12};

}  // namespace

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::optional<std::pair<int, int>> parse_size(std::string_view text) {
  const auto parts = split(text, 'x');
  if (parts.size() != 2) return std::nullopt;
  const auto width = parse_number<int>(parts[0], kPixels);
  const auto height = parse_number<int>(parts[1], kPixels);
  if (!width || !height) return std::nullopt;
  return std::pair(*width, *height);
}

std::optional<Vec3> parse_vec3(std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) return std::nullopt;
  Vec3 result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto value = parse_number<double>(parts[i], kCoordinates);
    if (!value) return std::nullopt;
    result[static_cast<Eigen::Index>(i)] = *value;
  }
  return result;
}

std::optional<CropWindow> parse_crop(std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 4) return std::nullopt;
  std::array<int, 4> edges{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto value = parse_number<int>(parts[i], {0, kPixels.high});
    if (!value) return std::nullopt;
    edges[i] = *value;
  }
  if (edges[0] >= edges[2] || edges[1] >= edges[3]) return std::nullopt;
  return CropWindow{edges[0], edges[1], edges[2], edges[3]};
}

CLI::Option* add_value(CLI::App& app, const std::string& names, const std::string& type_name,
                       const std::string& description, const std::string& expected,
                       std::function<bool(const std::string&)> read) {
  const std::string name = names.substr(names.rfind(',') + 1);
  const auto accept = [name, expected, read = std::move(read)](const CLI::results_t& arguments) {
    if (!read(arguments.front())) {
      throw CLI::ValidationError(name, fmt::format("'{}' is not {}", arguments.front(), expected));
    }
    return true;
  };
  return app.add_option(names, accept, description)->type_name(type_name);
}

}  // namespace vrc
