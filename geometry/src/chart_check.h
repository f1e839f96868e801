// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "chart_mesh.h"
#include "geometry/patch_atlas.h"

namespace vrc {

/// Of the linear map from the plane of a triangle with counter-clockwise corners `p` to (u, v), s1 >=
/// s2; s2 is negative where the map turns the triangle over.
[[nodiscard]] Vec2 singular_values_of_map(const std::array<Vec3, 3>& p, const std::array<Vec2, 3>& uv);

/// A triangle laid down in the plane with its lengths: longest edge along x, counter-clockwise.
[[nodiscard]] std::array<Vec2, 3> laid_down(const std::array<Vec3, 3>& p);

struct ChartCheck {
  std::vector<std::uint32_t> bad_faces;  ///< Flipped, or distorted beyond the limits of the options.
  bool overlaps = false;     ///< The chart's border crosses itself, or its faces wind twice round a vertex.
  double max_stretch = 1.0;  ///< Over the faces that are not bad.
  [[nodiscard]] bool passed() const { return bad_faces.empty() && !overlaps; }
};

/// Without flips, without faces that wind twice round a vertex and with a border that does not cross
/// itself the map is one to one: the border's loops then turn once in all, so one of them is outside and
/// the others are holes. Charts with handles thus never pass. Overlaps are looked for only when no face
/// is bad.
[[nodiscard]] ChartCheck check_chart(const ChartMesh& chart, std::span<const Vec2> uv,
                                     const PatchAtlasOptions& options);

}  // namespace vrc
