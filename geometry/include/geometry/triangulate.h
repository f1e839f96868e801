// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace vrc {

using Triangle = std::array<std::uint32_t, 3>;

/// Twice the vector area of a closed polygon (Newell): its direction is the mean normal, and for a
/// planar polygon its length is twice the area. Computed relative to the first corner.
[[nodiscard]] Vec3 newell_normal(std::span<const Vec3> corners);

/// Cuts one polygon into corners.size() - 2 triangles of indices into `corners`, keeping the sense of
/// rotation. Strictly convex polygons become a fan (quads: cut along the shorter diagonal); all
/// others are cut ear by ear, best-shaped ear first, in the coordinate plane that the Newell normal
/// faces most.
///
/// The signed areas in that plane always add up to the polygon's. For a simple polygon no triangle
/// is reversed. Collinear corners become corners of proper triangles wherever that is possible;
/// otherwise (spikes, self-intersections) a triangle may have zero or negative area.
/// Returns nothing when the Newell normal vanishes or there are fewer than three corners.
[[nodiscard]] std::vector<Triangle> triangulate_polygon(std::span<const Vec3> corners);

}  // namespace vrc
