// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh_repair.h"

namespace vrc {

/// The first half of `repair_mesh`: welds, drops degenerate and duplicate polygons, triangulates.
/// The result is not yet oriented nor detached (`flipped` and `detached_edge` are all 0), and
/// vertices without faces are still there. `weld_tolerance` as in RepairOptions.
[[nodiscard]] RepairedMesh clean_polygons(const PolygonSoup& soup, double weld_tolerance);

}  // namespace vrc
