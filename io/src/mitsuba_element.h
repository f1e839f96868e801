// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vrc {

/// One element of a Mitsuba scene and where it stands: includes are expanded, $parameters replaced,
/// and the names of elements and properties in snake_case (Mitsuba 0.6 wrote camelCase).
struct XmlElement {
  std::string tag;
  std::string file;
  std::size_t line = 0;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;

  /// Null when absent.
  [[nodiscard]] const std::string* find(std::string_view attribute) const;
  /// Empty when absent.
  [[nodiscard]] std::string_view get(std::string_view attribute) const;
  /// The opening tag, shortened for messages: `<bsdf type="phong" id="wall">`.
  [[nodiscard]] std::string label() const;
};

/// Throws InputError "FILE:LINE: <element>: problem".
[[noreturn]] void fail(const XmlElement& element, const std::string& problem);

/// What to do with parts of a scene that this program does not know.
class MitsubaReport {
 public:
  explicit MitsubaReport(bool lenient) : lenient_(lenient) {}

  /// Fails; when lenient, warns that `action` was taken and returns.
  void reject(const XmlElement& element, const std::string& problem, std::string_view action = "skipped");
  void warn(const XmlElement& element, const std::string& problem);
  void warn(std::string message) { warnings_.push_back(std::move(message)); }
  void note(std::string message) { notes_.push_back(std::move(message)); }

  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  bool lenient_;
  std::vector<std::string> warnings_;
  std::vector<std::string> notes_;
};

/// The existing file that `name` means in `element`: beside the file of the element, then in
/// `folders`. Throws InputError when there is none.
[[nodiscard]] std::filesystem::path resolve_file(const XmlElement& element, const std::string& name,
                                                 const std::vector<std::filesystem::path>& folders);

/// "specularReflectance" -> "specular_reflectance".
[[nodiscard]] std::string to_snake_case(std::string_view name);

}  // namespace vrc
