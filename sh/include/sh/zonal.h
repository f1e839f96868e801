// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/types.h"

// A zonal function depends on the angle to one axis only; entry l of a zonal vector, l = 0 .. L, is its
// coefficient of Y_l0 when the axis is z.
namespace vrc::sh {

/// Coefficients of f(cos theta) by a Gauss-Legendre rule of `nodes` nodes over cos theta in
/// [lower, 1], with f taken as 0 below `lower`: exact if f is a polynomial of degree
/// 2 nodes - 1 - order there. 0 <= order <= kMaxOrder, 1 <= nodes <= 512, -1 <= lower < 1.
[[nodiscard]] Eigen::VectorXd zonal_coefficients(int order, const std::function<double(double)>& f, int nodes,
                                                 double lower = -1.0);

/// Lambda_l z_l with Lambda_l = sqrt(4 pi / (2l + 1)): what a convolution multiplies band l by
/// [RamamoorthiHanrahan2001].
[[nodiscard]] Eigen::VectorXd band_factors(const Eigen::VectorXd& zonal);

/// Coefficients of (f * k)(n) = integral of f(w) k(n . w) dw, where `kernel` is the zonal vector of k.
/// Columns of `coefficients` are functions, rows their coefficients; `kernel` must have their order.
[[nodiscard]] Eigen::MatrixXd convolve(const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                                       const Eigen::VectorXd& kernel);

/// All coefficients of the zonal function turned so that its axis is the unit vector `axis`.
[[nodiscard]] Eigen::VectorXd turn_zonal(const Eigen::VectorXd& zonal, const Vec3& axis);

}  // namespace vrc::sh
