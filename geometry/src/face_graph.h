// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/surface_mesh.h"

namespace vrc {

/// What chart building asks of every face many times.
struct FaceGraph {
  explicit FaceGraph(const SurfaceMesh& mesh);

  [[nodiscard]] std::size_t size() const { return normal.size(); }

  std::vector<Vec3> normal;  ///< Geometric, unit.
  std::vector<double> area;
  /// The face across edge k, or kInvalidIndex at a boundary or crease.
  std::vector<std::array<std::uint32_t, 3>> neighbour;
};

}  // namespace vrc
