// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_export_check.h"

#include <limits>

#include "core/error.h"

namespace vrc {
namespace {

void check_arrays(const std::vector<SurfaceArray>& arrays, std::size_t count) {
  for (const SurfaceArray& array : arrays) {
    VRC_CHECK(!array.components.empty() && array.value_count() == count * array.components.size(),
              "array {} has {} values for {} elements", array.name, array.value_count(), count);
  }
}

}  // namespace

void check_surface_export(const SurfaceExport& surface) {
  const std::string& comment = surface.comment;
  VRC_CHECK(comment.find('\n') == std::string::npos && comment.find("--") == std::string::npos,
            "comment '{}'", comment);
  check_arrays(surface.vertex_arrays, surface.positions.size());
  check_arrays(surface.face_arrays, surface.triangles.size());
  VRC_CHECK(surface.positions.size() <= std::numeric_limits<std::int32_t>::max(), "{} vertices",
            surface.positions.size());
  for (const Triangle& triangle : surface.triangles) {
    for (const std::uint32_t v : triangle) {
      VRC_CHECK(v < surface.positions.size(), "vertex {} of {}", v, surface.positions.size());
    }
  }
}

}  // namespace vrc
