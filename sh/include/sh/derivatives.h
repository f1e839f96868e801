// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/types.h"
#include "sh/basis.h"

namespace vrc::sh {

/// One entry of a sparse matrix row. `factor` may be 0, then `index` is still valid to read.
struct RaisedTerm {
  int index = 0;  ///< A coefficient of order L + 1.
  double factor = 0.0;
};

/// The derivatives of the irregular solid harmonics I_lm(r) = Y_lm(r / |r|) / |r|^(l+1), r in length
/// units, which are exact and sparse [Hobson1931]:
///   dI_lm / dx_a (r) = sum of at most two terms: factor * I_(l+1)m'(r).
/// Applied twice they give second derivatives; x, y and z commute. Const and thread-safe.
class RaisingOperators {
 public:
  /// Rows for the coefficients of `order`, which read those of order + 1; 0 <= order < kMaxOrder.
  explicit RaisingOperators(int order);

  [[nodiscard]] int order() const { return order_; }
  /// Row of coefficient `coefficient` along axis 0, 1, 2 (x, y, z).
  [[nodiscard]] const std::array<RaisedTerm, 2>& terms(int coefficient, int axis) const {
    return rows_[coefficient][axis];
  }

  /// The derivative along `axis` of sums of I_lm from the sums of the order above, for example of the
  /// coefficients of a projection whose samples move: `raised` has coefficient_count(order + 1) rows
  /// and any number of columns, the result coefficient_count(order) rows.
  [[nodiscard]] Eigen::MatrixXd apply(int axis, const Eigen::Ref<const Eigen::MatrixXd>& raised) const;

 private:
  int order_;
  std::vector<std::array<std::array<RaisedTerm, 2>, 3>> rows_;
};

/// Y_lm with its derivatives in space at a unit vector, extended as a function of r / |r|; the
/// gradient is therefore tangent to the sphere. Rows are coefficients.
struct BasisJets {
  Eigen::VectorXd value;
  Eigen::Matrix<double, Eigen::Dynamic, 3> gradient;
  Eigen::Matrix<double, Eigen::Dynamic, 6> hessian;  ///< xx, yy, zz, xy, xz, yz
};

/// Evaluates the jets of an order. Const and thread-safe.
class DerivativeBasis {
 public:
  /// 0 <= order <= kMaxOrder - 2.
  explicit DerivativeBasis(int order);

  [[nodiscard]] BasisJets evaluate(const Vec3& direction) const;

 private:
  Basis basis_;  ///< Of order + 2.
  RaisingOperators raising_;
};

}  // namespace vrc::sh
