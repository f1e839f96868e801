// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>

#include "mitsuba_properties.h"
#include "transport/scene_description.h"

namespace vrc {

/// The scene's materials, each BSDF element read once and listed once.
class MaterialTable {
 public:
  MaterialTable(SceneDescription& scene, MitsubaContext& context) : scene_(scene), context_(context) {}

  /// Reads without listing: a BSDF that no shape uses is checked all the same.
  const Material& read(const XmlElement& bsdf);
  /// Index into `SceneDescription::materials`.
  std::uint32_t index(const XmlElement& bsdf);
  /// Index of Mitsuba's default material.
  std::uint32_t default_index();

 private:
  std::uint32_t add(Material material);

  SceneDescription& scene_;
  MitsubaContext& context_;
  std::map<const XmlElement*, Material> read_;
  std::map<const XmlElement*, std::uint32_t> indices_;
  std::optional<std::uint32_t> default_index_;
};

/// Adds a <shape> in world space: obj, ply, rectangle, cube, sphere, disk or cylinder, with its BSDF
/// and area emitter. An OBJ without BSDF keeps the materials of its .mtl, if it has one; any other
/// shape without one gets Mitsuba's default. Throws InputError at the element; when lenient, shapes of
/// other types are skipped.
void add_shape(const XmlElement& element, MitsubaContext& context, MaterialTable& materials,
               SceneDescription& scene);

}  // namespace vrc
