// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace vrc::sh {

/// Coefficients of the pointwise product of two functions, projected to an order. Exact up to rounding,
/// by a quadrature for the bands of all three: with D = order_a + order_b + order_out it holds
/// Q = (D / 2 + 1) (D + 1) rows of basis values of the largest order, and a product costs one pass over
/// the Q (n_a + n_b + n_out) values that it needs (180 thousand for three orders of 10, 5.1 million
/// for 24, memory bound). Const and thread-safe.
class Product {
 public:
  /// Orders in [0, kMaxOrder], else a logic_error.
  Product(int order_a, int order_b, int order_out);

  /// `a` has coefficient_count(order_a) entries, `b` coefficient_count(order_b).
  [[nodiscard]] Eigen::VectorXd operator()(const Eigen::Ref<const Eigen::VectorXd>& a,
                                           const Eigen::Ref<const Eigen::VectorXd>& b) const;

 private:
  int count_a_, count_b_, count_out_;
  Eigen::VectorXd weights_;  ///< Per direction of the quadrature.
  Eigen::MatrixXd table_;    ///< Directions x coefficients.
};

}  // namespace vrc::sh
