// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/frame.h"
#include "core/simd.h"

namespace vrc::sh {

/// Highest order of a FrameRotator: the entries of a band of one parity of m fit into a vector of 16.
inline constexpr int kMaxFrameOrder = 31;

/// Turns single coefficient vectors from a frame to the world without the matrices of `Rotation`:
/// R = Rz(a) Ry(b) Rz(c) = Rz(a + pi) X Rz(b + pi) X Rz(c), where X turns y to z. Turns about z cost four
/// operations for each pair of +m and -m, and X is a constant matrix with a quarter of its entries, so
/// order^3 / 3 multiplications, sixteen at a time, for each X. Const and thread-safe.
class FrameRotator {
 public:
  /// 0 <= order <= kMaxFrameOrder, else a logic_error.
  explicit FrameRotator(int order);

  [[nodiscard]] int order() const { return order_; }

  /// `local` holds coefficients of functions f of directions in the frame's coordinates, a column each;
  /// `world` receives those of w -> f(t . w, b . w, n . w) over world directions. The opposite way goes
  /// by `transposed(frame)`. The frame must be right-handed and orthonormal (not checked). Errors are
  /// below 2e-6 of a column's norm. Both have coefficient_count(order()) rows and equally many columns,
  /// else a logic_error, and must not overlap.
  void rotate(const Frame& frame, const Eigen::Ref<const Eigen::MatrixXf>& local,
              Eigen::Ref<Eigen::MatrixXf> world) const;

 private:
  int order_;
  std::vector<F16> columns_;  ///< Of the blocks of X: by bands, places, groups.
};

/// The frame whose axes are the rows of the matrix (tangent, bitangent, normal).
[[nodiscard]] Frame transposed(const Frame& frame);

}  // namespace vrc::sh
