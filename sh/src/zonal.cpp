// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/zonal.h"

#include <cmath>
#include <vector>

#include "core/error.h"
#include "sh/basis.h"
#include "sh/quadrature.h"

namespace vrc::sh {
namespace {

/// Rows of band l times factors[l].
template <typename Matrix>
void scale_bands(Matrix& coefficients, const Eigen::VectorXd& factors) {
  for (int l = 0; l < factors.size(); ++l) coefficients.middleRows(index(l, -l), 2 * l + 1) *= factors[l];
}

}  // namespace

Eigen::VectorXd zonal_coefficients(int order, const std::function<double(double)>& f, int nodes,
                                   double lower) {
  VRC_CHECK(order >= 0 && order <= kMaxOrder, "order {} is not in [0, {}]", order, kMaxOrder);
  VRC_CHECK(lower >= -1.0 && lower < 1.0, "lower bound {} is not in [-1, 1)", lower);
  const Quadrature rule = gauss_legendre(nodes, lower, 1.0);
  std::vector<double> polynomials(order + 1);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(order + 1);
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    legendre(rule.nodes[i], polynomials);
    const double value = 2.0 * kPi * rule.weights[i] * f(rule.nodes[i]);
    for (int l = 0; l <= order; ++l) result[l] += value * polynomials[l];
  }
  for (int l = 0; l <= order; ++l) result[l] *= std::sqrt((2.0 * l + 1.0) / (4.0 * kPi));
  return result;
}

Eigen::VectorXd band_factors(const Eigen::VectorXd& zonal) {
  Eigen::VectorXd factors = zonal;
  for (int l = 0; l < factors.size(); ++l) factors[l] *= std::sqrt(4.0 * kPi / (2.0 * l + 1.0));
  return factors;
}

Eigen::MatrixXd convolve(const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                         const Eigen::VectorXd& kernel) {
  VRC_CHECK(order_of(coefficients.rows()) + 1 == kernel.size(), "{} coefficients and a kernel of {} bands",
            coefficients.rows(), kernel.size());
  Eigen::MatrixXd result = coefficients;
  scale_bands(result, band_factors(kernel));
  return result;
}

Eigen::VectorXd turn_zonal(const Eigen::VectorXd& zonal, const Vec3& axis) {
  const Basis basis(static_cast<int>(zonal.size()) - 1);
  Eigen::VectorXd result(basis.size());
  basis.evaluate(axis, {result.data(), static_cast<std::size_t>(result.size())});
  scale_bands(result, band_factors(zonal));
  return result;
}

}  // namespace vrc::sh
