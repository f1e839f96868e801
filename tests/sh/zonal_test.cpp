// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/zonal.h"

#include <gtest/gtest.h>

#include "sh/projection.h"
#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

double identity(double t) { return t; }

TEST(Zonal, ClampedCosineHasTheKnownFactors) {
  const Eigen::VectorXd factors = band_factors(zonal_coefficients(8, identity, 16, 0.0));
  // [RamamoorthiHanrahan2001 eq. 8]; odd bands above 1 vanish.
  const double expected[9] = {kPi, 2.0 * kPi / 3.0, kPi / 4.0, 0.0,         -kPi / 24.0,
                              0.0, kPi / 64.0,      0.0,       -kPi / 128.0};
  for (int l = 0; l <= 6; ++l) EXPECT_NEAR(factors[l], expected[l], 1e-14) << l;
}

TEST(Zonal, AgreesWithProjectionOverTheSphere) {
  const int order = 12;
  const auto lobe = [](double t) { return std::exp(3.0 * (t - 1.0)); };
  const Eigen::VectorXd zonal = zonal_coefficients(order, lobe, 40);
  const Vec3 axis = Vec3(0.3, -0.7, 0.2).normalized();
  const Eigen::VectorXd projected = project(
      order, [&](const Vec3& d) { return lobe(d.dot(axis)); }, 60);
  EXPECT_LT((turn_zonal(zonal, axis) - projected).cwiseAbs().maxCoeff(), 1e-12);
  for (int l = 0; l <= order; ++l)
    EXPECT_NEAR(turn_zonal(zonal, Vec3::UnitZ())[index(l, 0)], zonal[l], 1e-14);
}

TEST(Zonal, ConvolutionIsTheIntegralOverTheKernel) {
  // An order-6 function against the clamped cosine: the irradiance, integrated over each hemisphere.
  test::ShRandom random(3);
  const int order = 6;
  const Eigen::VectorXd f = random.coefficients(order);
  const Eigen::VectorXd irradiance = convolve(f, zonal_coefficients(order, identity, 16, 0.0));
  const Quadrature heights = gauss_legendre(16, 0.0, 1.0);
  for (int trial = 0; trial < 5; ++trial) {
    const Mat3 frame = random.rotation();
    double expected = 0.0;
    for (int i = 0; i < 16; ++i) {
      const double z = heights.nodes[i], radius = std::sqrt(1.0 - z * z);
      for (int k = 0; k < 16; ++k) {
        const double phi = 2.0 * kPi * k / 16.0;
        const Vec3 d = frame * Vec3(radius * std::cos(phi), radius * std::sin(phi), z);
        expected += heights.weights[i] * kPi / 8.0 * z * test::function_value(f, d);
      }
    }
    EXPECT_NEAR(test::function_value(irradiance, frame.col(2)), expected, 1e-12);
  }
}

TEST(Zonal, ConvolvesColumnsAlike) {
  test::ShRandom random(4);
  Eigen::MatrixXd both(coefficient_count(4), 2);
  both << random.coefficients(4), random.coefficients(4);
  const Eigen::VectorXd kernel = zonal_coefficients(4, identity, 8);
  const Eigen::MatrixXd result = convolve(both, kernel);
  EXPECT_EQ(result.col(1), convolve(both.col(1), kernel).col(0));
}

TEST(Zonal, OrderZeroAndInvalidInput) {
  const Eigen::VectorXd constant = zonal_coefficients(
      0, [](double) { return 1.0; }, 1);
  EXPECT_NEAR(constant[0], std::sqrt(4.0 * kPi), 1e-14);
  EXPECT_NEAR(turn_zonal(constant, Vec3::UnitX())[0], constant[0], 1e-14);
  EXPECT_THROW((void)zonal_coefficients(-1, identity, 4), std::logic_error);
  EXPECT_THROW((void)zonal_coefficients(2, identity, 4, 1.0), std::logic_error);
  EXPECT_THROW((void)zonal_coefficients(2, identity, 0), std::logic_error);
  EXPECT_THROW((void)turn_zonal(Eigen::VectorXd(), Vec3::UnitX()), std::logic_error);
  EXPECT_THROW((void)convolve(Eigen::VectorXd::Zero(9), Eigen::VectorXd::Zero(2)), std::logic_error);
}

}  // namespace
}  // namespace vrc::sh
