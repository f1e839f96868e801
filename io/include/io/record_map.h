// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

#include "core/types.h"

namespace vrc {

/// What a record map shows of one cache record. World space; luminance derivatives are taken along
/// axis1 and axis2, per scene unit and per squared scene unit.
struct RecordMapEntry {
  Vec3f position = Vec3f::Zero();
  Vec3f normal = Vec3f::UnitZ();
  Vec3f axis1 = Vec3f::UnitX();  ///< Unit axes of the valid region, perpendicular to the normal.
  Vec3f axis2 = Vec3f::UnitY();
  float radius1 = 0.0f;  ///< Half axes of the valid region.
  float radius2 = 0.0f;
  Rgb radiance = Rgb::Zero();
  Vec2f gradient = Vec2f::Zero();
  Vec3f hessian = Vec3f::Zero();  ///< The entries 11, 12 and 22.
  std::uint32_t region = kInvalidIndex;
  std::uint32_t face = kInvalidIndex;  ///< Triangle of the scene.
  std::uint8_t is_sh = 0;              ///< 1 for records that hold spherical harmonics.
};

/// Binary PLY, one vertex for each record, with the properties
///   x y z nx ny nz, red green blue, quality, radius, r1 r2, e1x e1y e1z e2x e2y e2z, L_r L_g L_b,
///   g1 g2, h11 h12 h22, is_sh, region, face.
/// `quality` is the largest |eigenvalue| of the Hessian and `radius` is sqrt(r1 r2). Colours map the
/// logarithm of `radius` over the range of the file, dark for small; records of spherical harmonics
/// are red. Throws InputError when the path cannot be written.
void write_record_map(const std::filesystem::path& path, std::span<const RecordMapEntry> records);

/// Binary PLY mesh of the valid regions as flat fans of `segments` triangles, with normals, the
/// colours of `write_record_map` and `quality` (= sqrt(r1 r2)) at the vertices. `segments` >= 3.
/// Throws InputError when the path cannot be written.
void write_record_ellipses(const std::filesystem::path& path, std::span<const RecordMapEntry> records,
                           int segments = 32);

}  // namespace vrc
