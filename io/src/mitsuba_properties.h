// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"
#include "mitsuba_xml.h"

namespace vrc {

/// What every part of the scene reader shares.
struct MitsubaContext {
  MitsubaReport& report;
  std::vector<std::filesystem::path> search_folders;
  std::vector<std::filesystem::path> files;                       ///< That were read so far.
  std::map<std::string, const XmlElement*, std::less<>> objects;  ///< By id.

  /// Throws InputError when two objects share an id. `xml` must outlive the context.
  MitsubaContext(const MitsubaXml& xml, MitsubaReport& mitsuba_report);

  /// The object that `element` is or, for a <ref>, names; null (reported) when there is none.
  [[nodiscard]] const XmlElement* resolve(const XmlElement& element) const;
};

/// The children of one object, handed out by name and kind. `finish` reports those nobody asked for,
/// so that no setting of a scene is dropped silently. Getters throw InputError on a value of the
/// wrong kind and return nothing for an absent one.
class Properties {
 public:
  Properties(const XmlElement& element, MitsubaContext& context);

  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] std::optional<double> number(std::string_view name);
  [[nodiscard]] std::optional<int> integer(std::string_view name);
  [[nodiscard]] std::optional<bool> boolean(std::string_view name);
  [[nodiscard]] std::optional<std::string> string(std::string_view name);
  [[nodiscard]] std::optional<Vec3> vector(std::string_view name);
  /// Grey 0.5 for a texture, which is reported.
  [[nodiscard]] std::optional<Rgb> color(std::string_view name);
  [[nodiscard]] std::optional<Mat4> transform(std::string_view name);

  /// Nested objects and references of one kind ("bsdf", "film", ...), in the order of the file.
  [[nodiscard]] std::vector<const XmlElement*> objects(std::string_view tag);

  /// Accepts properties that make no difference here.
  void ignore(std::initializer_list<std::string_view> names);

  void finish();

 private:
  struct Child {
    const XmlElement* element;  ///< References resolved.
    std::string_view name;
    bool used = false;
  };
  /// Null when absent or a texture (reported).
  const XmlElement* take(std::string_view name, std::initializer_list<std::string_view> tags,
                         std::string_view texture_action);

  const XmlElement& element_;
  MitsubaContext& context_;
  std::vector<Child> children_;
};

}  // namespace vrc
