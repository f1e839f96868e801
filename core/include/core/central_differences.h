// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace vrc {

/// The points of central differences in two coordinates, in steps along each.
inline constexpr std::array<std::array<int, 2>, 9> kDifferenceStencil = {
    {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

/// A function at the points of `kDifferenceStencil`.
template <typename T>
using StencilValues = std::array<T, kDifferenceStencil.size()>;

/// Value, d1, d2, d11, d12, d22 by central differences of second order with the steps h1 and h2. T is a
/// number or a matrix.
template <typename T, typename Real>
[[nodiscard]] std::array<T, 6> central_differences(const StencilValues<T>& f, Real h1, Real h2) {
  return {f[0],
          T((f[1] - f[2]) * (Real(0.5) / h1)),
          T((f[3] - f[4]) * (Real(0.5) / h2)),
          T((f[1] - f[0] + (f[2] - f[0])) * (Real(1.0) / (h1 * h1))),
          T((f[5] - f[6] - f[7] + f[8]) * (Real(0.25) / (h1 * h2))),
          T((f[3] - f[0] + (f[4] - f[0])) * (Real(1.0) / (h2 * h2)))};
}

}  // namespace vrc
