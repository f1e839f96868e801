// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "chart_mesh.h"

namespace vrc {

/// Least-squares conformal map of a connected chart with a boundary [Levy2002]: (u, v) per vertex, with
/// position, rotation and scale as they come. Nothing when the chart is no mesh for
/// CGAL or the solver fails; the result may have flips and must be checked.
[[nodiscard]] std::optional<std::vector<Vec2>> conformal_map(const ChartMesh& chart);

}  // namespace vrc
