// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/surface_export.h"

namespace vrc {

/// Fails as a broken invariant where an array does not fit the mesh or an index is out of range.
void check_surface_export(const SurfaceExport& surface);

[[nodiscard]] inline bool is_point_cloud(const SurfaceExport& surface) {
  return surface.triangles.empty() && surface.face_arrays.empty();
}

}  // namespace vrc
