// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "geometry/curvature.h"
#include "geometry/patch_atlas.h"
#include "io/surface_export.h"

namespace vrc {

/// The mesh with a vertex for each sector and the arrays
///   nx ny nz, red green blue, quality (max |k|), k1 k2 mean gauss, d1x..d1z, d2x..d2z, sh_radius;
/// and of faces patch, region, material. `sh_radius` is the distance over which the normal turns by
/// `max_normal_deviation`, at most the diagonal of the mesh. `color` gives the linear colour of a sector.
[[nodiscard]] SurfaceExport curvature_export(const PatchAtlas& atlas,
                                             std::span<const PrincipalCurvatures> sectors,
                                             double max_normal_deviation,
                                             const std::function<Rgb(std::size_t sector)>& color);

}  // namespace vrc
