// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace vrc::sh {
namespace {

TEST(GaussLegendre, KnownRules) {
  const Quadrature one = gauss_legendre(1);
  EXPECT_EQ(one.nodes[0], 0.0);
  EXPECT_NEAR(one.weights[0], 2.0, 1e-15);
  const Quadrature three = gauss_legendre(3);
  EXPECT_NEAR(three.nodes[0], -std::sqrt(0.6), 1e-15);
  EXPECT_EQ(three.nodes[1], 0.0);
  EXPECT_NEAR(three.weights[0], 5.0 / 9.0, 1e-15);
  EXPECT_NEAR(three.weights[1], 8.0 / 9.0, 1e-15);
}

TEST(GaussLegendre, IntegratesPolynomialsExactly) {
  for (const int count : {1, 2, 5, 32, 101, 512}) {
    const Quadrature rule = gauss_legendre(count);
    std::vector<double> sums(2 * count, 0.0), p(2 * count);
    for (int i = 0; i < count; ++i) {
      legendre(rule.nodes[i], p);
      for (int l = 0; l < 2 * count; ++l) sums[l] += rule.weights[i] * p[l];
    }
    for (int l = 0; l < 2 * count; ++l) ASSERT_NEAR(sums[l], l == 0 ? 2.0 : 0.0, 1e-13) << count << ' ' << l;
  }
}

TEST(GaussLegendre, NodesAreZerosInOrder) {
  for (const int count : {2, 17, 512}) {
    const Quadrature rule = gauss_legendre(count);
    std::vector<double> p(count + 1);
    for (int i = 0; i < count; ++i) {
      if (i > 0) {
        ASSERT_LT(rule.nodes[i - 1], rule.nodes[i]);
      }
      const double t = rule.nodes[i];
      legendre(t, p);
      // The distance to the zero by the slope there.
      ASSERT_LT(std::abs(p[count] * (1.0 - t * t) / (count * p[count - 1])), 1e-14);
    }
  }
}

TEST(GaussLegendre, OtherIntervals) {
  const Quadrature rule = gauss_legendre(20, 0.0, 2.0);
  double sum = 0.0;
  for (int i = 0; i < 20; ++i) sum += rule.weights[i] * std::exp(rule.nodes[i]);
  EXPECT_NEAR(sum, std::exp(2.0) - 1.0, 1e-14);
}

TEST(SphereQuadrature, IntegratesMonomials) {
  const SphereQuadrature rule = sphere_quadrature(6);
  double area = 0.0, x2 = 0.0, x2y2z2 = 0.0, z6 = 0.0, x5z = 0.0;
  for (std::size_t i = 0; i < rule.directions.size(); ++i) {
    const Vec3& d = rule.directions[i];
    EXPECT_NEAR(d.norm(), 1.0, 1e-15);
    area += rule.weights[i];
    x2 += rule.weights[i] * d.x() * d.x();
    x2y2z2 += rule.weights[i] * d.cwiseAbs2().prod();
    z6 += rule.weights[i] * std::pow(d.z(), 6);
    x5z += rule.weights[i] * std::pow(d.x(), 5) * d.z();
  }
  EXPECT_NEAR(area, 4.0 * kPi, 1e-13);
  EXPECT_NEAR(x2, 4.0 * kPi / 3.0, 1e-13);
  EXPECT_NEAR(x2y2z2, 4.0 * kPi / 105.0, 1e-14);
  EXPECT_NEAR(z6, 4.0 * kPi / 7.0, 1e-13);
  EXPECT_NEAR(x5z, 0.0, 1e-14);
  EXPECT_EQ(sphere_quadrature(0).directions.size(), 1u);
}

TEST(GaussLegendre, InvalidInput) {
  EXPECT_THROW((void)gauss_legendre(0), std::logic_error);
  EXPECT_THROW((void)gauss_legendre(513), std::logic_error);
  EXPECT_THROW((void)gauss_legendre(4, 1.0, 1.0), std::logic_error);
  EXPECT_THROW((void)sphere_quadrature(-1), std::logic_error);
  EXPECT_THROW(legendre(0.5, {}), std::logic_error);
}

}  // namespace
}  // namespace vrc::sh
