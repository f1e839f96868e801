// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/simd.h"

namespace vrc::sh {

/// Sums over many scattered directions of Y_lm times values, sum_i v_i Y_lm(d_i), for 32 values at once.
///
/// The adjoint of a spherical Fourier transform at nonequispaced nodes [Kunis2003]: values are spread onto a
/// grid over (theta, phi) by the weights with which cubic B-splines interpolate there, and the sums over the
/// grid, whose rows see cos(m phi) and sin(m phi) alone, take no longer for more directions. A direction
/// costs 16 cells instead of (order + 1)^2 coefficients. Const and thread-safe.
class ScatteredSums {
 public:
  static constexpr int kValues = 2 * kLanes;
  using Values = std::array<F16, 2>;

  /// Where values are spread; storage only.
  class Grid {
    friend ScatteredSums;
    std::vector<Values> cells, row_sums;
  };

  /// 0 <= order <= kMaxOrder, else a logic_error.
  explicit ScatteredSums(int order);

  [[nodiscard]] int order() const { return order_; }

  /// Makes `grid` an empty one of this order.
  void clear(Grid& grid) const;
  /// Adds the values of sixteen unit directions; those of other lanes than the active ones are not read.
  void add(I16 active, const V3x16& directions, std::span<const Values, kLanes> values, Grid& grid) const;
  /// The sums by `index(l, m)`. Relative errors of the values' products with a band l: 7e-3 (l / order)^4 at
  /// most. The grid is no longer usable.
  [[nodiscard]] std::vector<Values> sums(Grid& grid) const;

 private:
  void fold_margins(Grid& grid) const;
  [[nodiscard]] std::size_t cell(int row, int column) const;

  int order_;
  int rows_, columns_;              ///< Of the grid, without margins.
  std::vector<float> along_phi_;    ///< Row 2 m - 1: cos(m phi), row 2 m: sin(m phi), over the columns.
  std::vector<float> along_theta_;  ///< Rows l = m .. order for each m: Y_lm(theta, 0), over the rows.
};

}  // namespace vrc::sh
