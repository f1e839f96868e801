// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "face_graph.h"
#include "geometry/patch_atlas.h"

namespace vrc {

/// Charts before flattening: the faces of each, in rising order. Each chart is connected over smooth
/// edges. A region that bends by less than a degree is one chart; in the others the normals of a
/// chart lie within the cone of the options.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> grow_charts(const SurfaceMesh& mesh,
                                                                  const FaceGraph& graph,
                                                                  const PatchAtlasOptions& options);

}  // namespace vrc
