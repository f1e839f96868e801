// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/frame.h"
#include "core/simd.h"

namespace vrc::sh {

/// Highest order of a FrameRotator: the eight kinds of entries of a band fit into vectors of 16.
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

  /// From the coefficients of f(t . w, b . w, n . w), w in the frame's coordinates, those of the same
  /// function of world directions, for each column. The frame must be right-handed and orthonormal (not
  /// checked). The transposed frame turns the world to the frame. Errors are below 2e-6 of the norm of
  /// the column. Both have coefficient_count(order()) rows and the same columns, and are not the same
  /// memory; else a logic_error.
  void rotate(const Frame& frame, const Eigen::Ref<const Eigen::MatrixXf>& local,
              Eigen::Ref<Eigen::MatrixXf> world) const;

 private:
  int order_;
  std::vector<F16> columns_;  ///< Of the blocks of X: bands, groups, entries.
};

/// The frame whose axes are the rows of the matrix (tangent, bitangent, normal).
[[nodiscard]] Frame transposed(const Frame& frame);

}  // namespace vrc::sh
