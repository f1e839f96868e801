// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/curvature.h"

namespace vrc {

/// A scalar made of the principal curvatures k1 >= k2.
enum class CurvatureQuantity : std::uint8_t {
  kMean,  ///< (k1 + k2) / 2
  kK1,
  kK2,
  kGauss,  ///< k1 k2
  kMax,    ///< max(|k1|, |k2|)
};

[[nodiscard]] double value_of(const PrincipalCurvatures& curvature, CurvatureQuantity quantity);
[[nodiscard]] constexpr bool is_signed(CurvatureQuantity quantity) {
  return quantity != CurvatureQuantity::kMax;
}

/// Of every sector.
[[nodiscard]] std::vector<PrincipalCurvatures> principal_curvatures(const CurvatureField& field);

struct ValueRange {
  double low = 0.0;
  double high = 0.0;
};

struct ValueSummary {
  double min = 0.0, median = 0.0, max = 0.0;
  ValueRange robust;  ///< From the 2nd to the 98th percentile.
};

/// `values` must not be empty.
[[nodiscard]] ValueSummary summarize(std::vector<double> values);

/// What the ends of a colour map stand for: the robust range, made symmetrical about 0 where the
/// quantity is signed. It is widened where it holds no more than rounding, so that a plane or a sphere
/// has one colour; `size` is the diagonal of the mesh.
[[nodiscard]] ValueRange color_range(const ValueSummary& summary, CurvatureQuantity quantity, double size);

/// A part of the mesh connected over edges.
struct ComponentCurvature {
  std::size_t faces = 0;
  std::size_t crease_edges = 0;  ///< Where bending is not part of the curvature.
  bool closed = true;
  int euler_characteristic = 0;
  double gauss_integral = 0.0;  ///< Of K over the area; 2 pi times the characteristic on smooth closed ones.
};

/// In the order of their smallest faces. K is linear over each face.
[[nodiscard]] std::vector<ComponentCurvature> integrate_components(
    const SurfaceMesh& mesh, std::span<const PrincipalCurvatures> sectors);

}  // namespace vrc
