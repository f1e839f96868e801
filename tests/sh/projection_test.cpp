// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/projection.h"

#include <gtest/gtest.h>

#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

/// Uniform directions with two channels: a constant and (1 + z)^3.
struct Samples {
  std::vector<V3x16> directions;
  std::vector<F16> weights, values;

  explicit Samples(std::size_t packets) : directions(packets), weights(packets), values(2 * packets) {
    test::ShRandom random(11);
    for (std::size_t p = 0; p < packets; ++p) {
      for (int i = 0; i < kLanes; ++i) {
        const Vec3f d = random.direction().cast<float>();
        directions[p].x[i] = d.x(), directions[p].y[i] = d.y(), directions[p].z[i] = d.z();
      }
      weights[p] = splat(static_cast<float>(4.0 * kPi / (16.0 * static_cast<double>(packets))));
      const F16 k = 1.0f + directions[p].z;
      values[p] = splat(2.0f);
      values[packets + p] = k * k * k;
    }
  }
  [[nodiscard]] SamplePackets view() const { return {directions, weights, values}; }
};

TEST(Projection, RecoversCoefficients) {
  test::ShRandom random(1);
  for (const int order : {0, 3, 20}) {
    const Eigen::VectorXd c = random.coefficients(order);
    const Eigen::VectorXd back = project(
        order, [&](const Vec3& d) { return test::function_value(c, d); }, 2 * order);
    EXPECT_LT((back - c).cwiseAbs().maxCoeff(), 1e-12) << order;
  }
}

TEST(Projection, SamplesAgreeWithTheSlowSum) {
  // Packets that do not fill the last batch, one of their lanes empty.
  const int order = 7;
  const Basis basis(order);
  Samples samples(7);
  samples.weights[6][15] = 0.0f;
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(basis.size(), 2);
  for (std::size_t p = 0; p < 7; ++p) {
    for (int i = 0; i < kLanes; ++i) {
      const V3x16& d = samples.directions[p];
      const Eigen::VectorXd y = test::harmonics(basis, Vec3(d.x[i], d.y[i], d.z[i]));
      for (std::size_t c = 0; c < 2; ++c)
        expected.col(c) += static_cast<double>(samples.weights[p][i] * samples.values[7 * c + p][i]) * y;
    }
  }
  const Eigen::MatrixXd sum = project_samples(basis, samples.view());
  ASSERT_EQ(sum.cols(), 2);
  EXPECT_LT((sum - expected).cwiseAbs().maxCoeff(), 2e-5);
}

TEST(Projection, MonteCarloConvergesToQuadrature) {
  const int order = 6;
  const auto f = [](const Vec3& d) { return std::pow(1.0 + d.z(), 3); };
  const Eigen::VectorXd exact = project(order, f, 10);
  for (const std::size_t packets : {64, 1024, 16384}) {
    const Eigen::MatrixXd sum = project_samples(Basis(order), Samples(packets).view());
    EXPECT_NEAR(sum(0, 0), 2.0 * std::sqrt(4.0 * kPi), 1e-4);
    // The variances of all coefficients: (n integral of f^2 - |exact|^2) / N.
    const double squared = 2.0 * kPi * 128.0 / 7.0;
    const double deviation = std::sqrt((coefficient_count(order) * squared - exact.squaredNorm()) /
                                       (16.0 * static_cast<double>(packets)));
    const double error = (sum.col(1) - exact).norm();
    EXPECT_LT(error, 1.6 * deviation) << packets;
    EXPECT_GT(error, 0.5 * deviation) << packets;
  }
}

TEST(Projection, EmptyAndInvalidInput) {
  const Basis basis(2);
  EXPECT_EQ(project_samples(basis, {}).size(), 0);
  Samples samples(3);
  SamplePackets view = samples.view();
  view.weights = view.weights.first(2);
  EXPECT_THROW((void)project_samples(basis, view), std::logic_error);
  view = samples.view();
  view.values = view.values.first(5);
  EXPECT_THROW((void)project_samples(basis, view), std::logic_error);
  EXPECT_THROW((void)project(
                   -1, [](const Vec3&) { return 1.0; }, 2),
               std::logic_error);
}

}  // namespace
}  // namespace vrc::sh
