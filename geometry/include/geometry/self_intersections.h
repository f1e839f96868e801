// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/surface_mesh.h"

namespace vrc {

/// Pairs of faces of one mesh that meet in more than the corners and edges that they share.
struct SelfIntersections {
  std::size_t pair_count = 0;
  /// The first pairs in rising order, the smaller face first.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first_pairs;
};

/// Exact: decided without rounding for the stored positions. Corners at equal positions count as
/// shared, so faces that the repair detached from each other do not intersect along their old edge.
/// Coplanar faces that overlap intersect; faces that touch without sharing the corner do, too.
/// Faces whose corners lie on a line are left out.
[[nodiscard]] SelfIntersections find_self_intersections(const SurfaceMesh& mesh, std::size_t pairs_kept = 8);

}  // namespace vrc
