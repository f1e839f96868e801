// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "chart_mesh.h"
#include "geometry/patch_atlas.h"

namespace vrc {

/// A chart with its map: (u, v) per vertex from (0, 0), of the same area as the surface, the longer
/// side of the smallest rectangle around it along u.
struct FlatChart {
  ChartMesh mesh;
  ChartMethod method = ChartMethod::kSingleFace;
  std::vector<Vec2> uv;
};

/// Flattens a connected chart by the first method whose map passes the check. A chart that none can
/// flatten loses its bad faces, if these are few, or is halved; the parts are flattened in turn. It
/// ends at single faces at the latest, which always succeed.
[[nodiscard]] std::vector<FlatChart> flatten_chart(ChartMesh chart, const PatchAtlasOptions& options);

/// Unit mean normal by area; tangent along the mean direction of u.
[[nodiscard]] Frame mean_frame(const FlatChart& chart);

}  // namespace vrc
