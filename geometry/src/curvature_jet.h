// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/surface_mesh.h"

namespace vrc {

/// Answers which vertices surround a sector without a crease between.
class SectorNeighbourhoods {
 public:
  explicit SectorNeighbourhoods(const SurfaceMesh& mesh);

  /// The sector's own position first, then ring by ring; each position once.
  [[nodiscard]] std::vector<Vec3> points(std::uint32_t sector, int rings);

 private:
  const SurfaceMesh& mesh_;
  std::vector<std::uint32_t> begin_;  ///< Per sector: its corners are corners_[begin_[s], begin_[s + 1]).
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> visited_by_;  ///< Per sector the last query that reached it.
  std::uint32_t query_ = 0;
};

/// The shape operator (as CurvatureField gives it, tangent to `normal`) of the osculating jet of
/// `degree` 2 to 4 at points[0] [Cazals2005]. The degree is lowered where there are fewer than half as
/// many points again as the jet has coefficients; nothing if that does not help, or if the fit is
/// ill-conditioned or faces away from `normal`.
[[nodiscard]] std::optional<Mat3> fit_jet(std::span<const Vec3> points, const Vec3& normal, int degree);

}  // namespace vrc
