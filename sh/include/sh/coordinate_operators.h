// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <array>

namespace vrc::sh {

/// What multiplication by a coordinate and differentiation make of harmonics, as matrices. With Y the
/// vector of all Y_lm in the direction r / |r|, extended to space as constant along r, and x_a the
/// coordinates of that direction:
///   x_a Y = multiply[a] Y,   dY / dr_a = differentiate[a] Y / |r|.
/// A band is coupled with its two neighbours only. From the raising operators A of RaisingOperators (k in
/// band l, j in band l + 1) and the symmetry of multiplication: multiply[k][j] = multiply[j][k] =
/// -A[k][j] / (2l + 1), differentiate[k][j] = -l multiply[k][j], differentiate[j][k] = (l + 2)
/// multiply[k][j].
struct CoordinateOperators {
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  /// coefficient_count(order) rows and coefficient_count(order + 1) columns. 0 <= order < kMaxOrder.
  explicit CoordinateOperators(int order);

  std::array<Matrix, 3> multiply, differentiate;
};

}  // namespace vrc::sh
