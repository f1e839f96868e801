// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/basis.h"

#include <gtest/gtest.h>

#include "sh/projection.h"
#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

using test::harmonics;
using test::test_directions;

TEST(Basis, IndicesFollowOneAnother) {
  int expected = 0;
  for (int l = 0; l <= 5; ++l) {
    EXPECT_EQ(order_of(coefficient_count(l)), l);
    for (int m = -l; m <= l; ++m) EXPECT_EQ(index(l, m), expected++);
    EXPECT_EQ(coefficient_count(l), expected);
  }
}

TEST(Basis, FirstBandIsTheDirection) {
  for (const Vec3& d : test_directions(20)) {
    const Eigen::VectorXd y = harmonics(Basis(1), d);
    const double k = std::sqrt(3.0 / (4.0 * kPi));
    EXPECT_NEAR(y[0], std::sqrt(1.0 / (4.0 * kPi)), 1e-15);
    EXPECT_NEAR(y[index(1, -1)], k * d.y(), 1e-15);
    EXPECT_NEAR(y[index(1, 0)], k * d.z(), 1e-15);
    EXPECT_NEAR(y[index(1, 1)], k * d.x(), 1e-15);
  }
}

TEST(Basis, AgreesWithTheExplicitSums) {
  // The sums cancel: they lose a factor of (1 + sqrt(2))^l of the precision of long double.
  for (const auto& [order, tolerance] : {std::pair(10, 1e-13), std::pair(24, 1e-8)}) {
    for (const Vec3& d : test_directions(30)) {
      const Eigen::VectorXd y = harmonics(Basis(order), d);
      for (int l = 0; l <= order; ++l) {
        for (int m = -l; m <= l; ++m)
          ASSERT_NEAR(y[index(l, m)], test::slow_harmonic(l, m, d), tolerance)
              << l << ' ' << m << " at " << d.transpose();
      }
    }
  }
}

TEST(Basis, Orthonormal) {
  for (const int order : {0, 1, 24}) {
    const SphereQuadrature rule = sphere_quadrature(2 * order);
    const Eigen::MatrixXd table = basis_table(Basis(order), rule);
    const Eigen::Map<const Eigen::VectorXd> weights(rule.weights.data(), table.rows());
    const Eigen::MatrixXd gram = table.transpose() * weights.asDiagonal() * table;
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-11)
        << order;
  }
}

TEST(Basis, AdditionTheorem) {
  const int order = 30;
  const Basis basis(order);
  const std::vector<Vec3> directions = test_directions(20);
  std::vector<double> p(order + 1);
  for (std::size_t i = 0; i + 1 < directions.size(); ++i) {
    const Vec3 &a = directions[i], &b = directions[i + 1];
    const Eigen::VectorXd product = harmonics(basis, a).cwiseProduct(harmonics(basis, b));
    legendre(a.dot(b), p);
    for (int l = 0; l <= order; ++l)
      ASSERT_NEAR(product.segment(index(l, -l), 2 * l + 1).sum(), (2 * l + 1) / (4.0 * kPi) * p[l], 1e-12);
  }
}

TEST(Basis, HighestOrderStaysAccurate) {
  const Basis basis(kMaxOrder);
  std::vector<float> single(basis.size());
  for (const Vec3& d : test_directions(20)) {
    const Eigen::VectorXd y = harmonics(basis, d);
    EXPECT_NEAR(y.squaredNorm(), basis.size() / (4.0 * kPi), 1e-8);
    const Vec3f f = d.cast<float>();
    basis.evaluate(f, single);
    const double norm =
        Eigen::Map<const Eigen::VectorXf>(single.data(), basis.size()).cast<double>().squaredNorm();
    EXPECT_NEAR(norm, basis.size() / (4.0 * kPi), 1.0) << d.transpose();
  }
}

TEST(Basis, SingleAndSixteenWideAgreeWithDouble) {
  for (const int order : {0, 1, 2, 10, 24, 30}) {
    const Basis basis(order);
    const std::vector<Vec3> directions = test_directions(100);
    std::vector<F16> wide(basis.size());
    std::vector<float> single(basis.size());
    for (std::size_t begin = 0; begin + kLanes <= directions.size(); begin += kLanes) {
      V3x16 packet;
      for (int i = 0; i < kLanes; ++i) {
        const Vec3f d = directions[begin + i].cast<float>();
        packet.x[i] = d.x(), packet.y[i] = d.y(), packet.z[i] = d.z();
      }
      basis.evaluate(packet, wide);
      for (int i = 0; i < kLanes; ++i) {
        const Eigen::VectorXd exact = harmonics(basis, directions[begin + i]);
        basis.evaluate(Vec3f(directions[begin + i].cast<float>()), single);
        for (int j = 0; j < basis.size(); ++j) {
          ASSERT_NEAR(wide[j][i], exact[j], 5e-5) << order << ' ' << j;
          ASSERT_NEAR(single[j], exact[j], 5e-5) << order << ' ' << j;
        }
      }
    }
  }
}

TEST(Basis, StrideLeavesTheOtherPlacesAlone) {
  const Basis basis(6);
  const V3x16 packet = splat3(Vec3(0.6, 0.0, -0.8));
  std::vector<F16> dense(basis.size()), strided(3 * basis.size(), splat(-9.0f));
  basis.evaluate(packet, dense);
  basis.evaluate(packet, strided, 3);
  for (int j = 0; j < basis.size(); ++j) {
    EXPECT_EQ(strided[3 * j][5], dense[j][5]);
    EXPECT_EQ(strided[3 * j + 1][5], -9.0f);
    EXPECT_EQ(strided[3 * j + 2][5], -9.0f);
  }
}

TEST(Basis, InvalidInput) {
  EXPECT_THROW(Basis(-1), std::logic_error);
  EXPECT_THROW(Basis(kMaxOrder + 1), std::logic_error);
  EXPECT_THROW((void)order_of(5), std::logic_error);
  EXPECT_THROW((void)order_of(0), std::logic_error);
  std::vector<double> out(8);
  EXPECT_THROW(evaluate(2, Vec3::UnitZ(), out), std::logic_error);
  std::vector<F16> wide(9);
  EXPECT_THROW(Basis(2).evaluate(V3x16{}, wide, 2), std::logic_error);
  out.resize(9);
  evaluate(2, Vec3::UnitZ(), out);
  EXPECT_NEAR(out[index(2, 0)], std::sqrt(5.0 / (4.0 * kPi)), 1e-15);
}

}  // namespace
}  // namespace vrc::sh
