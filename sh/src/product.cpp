// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/product.h"

#include <algorithm>

#include "core/error.h"
#include "sh/projection.h"

namespace vrc::sh {

Product::Product(int order_a, int order_b, int order_out)
    : count_a_(coefficient_count(order_a)),
      count_b_(coefficient_count(order_b)),
      count_out_(coefficient_count(order_out)) {
  VRC_CHECK(std::min({order_a, order_b, order_out}) >= 0, "negative order among {}, {}, {}", order_a, order_b,
            order_out);
  const Basis basis(std::max({order_a, order_b, order_out}));
  const SphereQuadrature rule = sphere_quadrature(order_a + order_b + order_out);
  weights_ =
      Eigen::Map<const Eigen::VectorXd>(rule.weights.data(), static_cast<Eigen::Index>(rule.weights.size()));
  table_ = basis_table(basis, rule);
}

Eigen::VectorXd Product::operator()(const Eigen::Ref<const Eigen::VectorXd>& a,
                                    const Eigen::Ref<const Eigen::VectorXd>& b) const {
  VRC_CHECK(a.size() == count_a_ && b.size() == count_b_, "{} and {} coefficients instead of {} and {}",
            a.size(), b.size(), count_a_, count_b_);
  const Eigen::VectorXd values = (table_.leftCols(count_a_) * a).cwiseProduct(table_.leftCols(count_b_) * b);
  return table_.leftCols(count_out_).transpose() * values.cwiseProduct(weights_);
}

}  // namespace vrc::sh
