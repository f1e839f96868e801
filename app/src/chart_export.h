// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "geometry/patch_atlas.h"
#include "io/surface_export.h"

namespace vrc {

/// The mesh cut along its charts and creases: vertex arrays nx ny nz, s t; face arrays red green blue,
/// patch, stretch, area_distortion, material. (s, t) is the packed layout divided by its longer side.
/// `color` gives the linear colour of a face.
[[nodiscard]] SurfaceExport chart_export(const PatchAtlas& atlas,
                                         const std::function<Rgb(std::size_t face)>& color);

/// max(s1 s2, 1 / (s1 s2)) of a face's singular values.
[[nodiscard]] double area_distortion(const PatchAtlas& atlas, std::size_t face);

}  // namespace vrc
