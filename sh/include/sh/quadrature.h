// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace vrc::sh {

/// Legendre polynomials P_0 .. P_(n-1) at t in [-1, 1], n = out.size() >= 1.
void legendre(double t, std::span<double> out);

/// Nodes in ascending order with their weights.
struct Quadrature {
  std::vector<double> nodes, weights;
};

/// Gauss-Legendre rule on [lower, upper], exact for polynomials of degree 2 count - 1. On [-1, 1]
/// absolute errors of nodes and weights are below 1e-14. 1 <= count <= 512, lower < upper.
[[nodiscard]] Quadrature gauss_legendre(int count, double lower = -1.0, double upper = 1.0);

/// Unit directions with their solid angles [sr], which add up to 4 pi.
struct SphereQuadrature {
  std::vector<Vec3> directions;
  std::vector<double> weights;
};

/// Gauss-Legendre in cos theta times equal steps in phi: exact for the harmonics of the bands
/// 0 .. degree, so degree 2 L for products of two functions of order L. 0 <= degree <= 1022;
/// (degree / 2 + 1) (degree + 1) directions.
[[nodiscard]] SphereQuadrature sphere_quadrature(int degree);

}  // namespace vrc::sh
