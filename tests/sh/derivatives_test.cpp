// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/derivatives.h"

#include <gtest/gtest.h>

#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

using test::harmonics;
using test::test_directions;

/// Y_lm(r / |r|) / |r|^(l+1) for all coefficients.
Eigen::VectorXd irregular(const Basis& basis, const Vec3& r) {
  Eigen::VectorXd result = harmonics(basis, r.normalized());
  for (int l = 0; l <= basis.order(); ++l)
    result.segment(index(l, -l), 2 * l + 1) /= std::pow(r.norm(), l + 1);
  return result;
}

/// Fourth-order central difference along an axis.
template <typename Function>
auto difference(const Function& f, const Vec3& r, int axis, double h) {
  const Vec3 step = h * Vec3::Unit(axis);
  return ((8.0 * (f(r + step) - f(r - step)) - (f(r + 2.0 * step) - f(r - 2.0 * step))) / (12.0 * h)).eval();
}

TEST(RaisingOperators, FirstRowsByHand) {
  // I_00 = c / r and I_1 = sqrt(3) c (y, z, x) / r^3: the gradient of I_00 is -(x, y, z) c / r^3.
  const RaisingOperators raising(0);
  const int expected[3] = {index(1, 1), index(1, -1), index(1, 0)};
  for (int axis = 0; axis < 3; ++axis) {
    double sums[4] = {};
    for (const RaisedTerm& t : raising.terms(0, axis)) sums[t.index] += t.factor;
    for (int j = 1; j < 4; ++j)
      EXPECT_NEAR(sums[j], j == expected[axis] ? -1.0 / std::sqrt(3.0) : 0.0, 1e-15);
  }
}

TEST(RaisingOperators, AreTheDerivativesOfIrregularHarmonics) {
  const int order = 20;
  const RaisingOperators raising(order);
  const Basis low(order), high(order + 1);
  for (const Vec3& d : test_directions(20)) {
    const Vec3 r = 1.3 * d;
    const Eigen::VectorXd raised = irregular(high, r);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::VectorXd exact = raising.apply(axis, raised);
      const Eigen::VectorXd numeric =
          difference([&](const Vec3& p) { return irregular(low, p); }, r, axis, 1e-3);
      EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-6) << d.transpose();
    }
  }
}

TEST(RaisingOperators, CommuteAndAddUpToTheLaplacian) {
  const int order = 20;
  const RaisingOperators once(order), twice(order + 1);
  test::ShRandom random(5);
  const Eigen::VectorXd raised = random.coefficients(order + 2);
  const auto second = [&](int a, int b) { return once.apply(a, twice.apply(b, raised)); };
  EXPECT_LT((second(0, 1) - second(1, 0)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((second(0, 2) - second(2, 0)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((second(1, 2) - second(2, 1)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((second(0, 0) + second(1, 1) + second(2, 2)).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(DerivativeBasis, AgreesWithFiniteDifferences) {
  constexpr int kHessianColumn[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  for (const int order : {0, 1, 20}) {
    const DerivativeBasis derivatives(order);
    const Basis basis(order);
    for (const Vec3& d : test_directions(20)) {
      const BasisJets jets = derivatives.evaluate(d);
      ASSERT_EQ(jets.value.size(), basis.size());
      EXPECT_LT((jets.value - harmonics(basis, d)).cwiseAbs().maxCoeff(), 1e-12);
      for (int axis = 0; axis < 3; ++axis) {
        const auto y = [&](const Vec3& r) { return harmonics(basis, r.normalized()); };
        EXPECT_LT((jets.gradient.col(axis) - difference(y, d, axis, 1e-3)).cwiseAbs().maxCoeff(), 1e-6);
        // Off the sphere the gradient of a function of r / |r| falls with 1 / |r|.
        const auto gradient = [&](const Vec3& r) -> Eigen::Matrix<double, Eigen::Dynamic, 3> {
          return derivatives.evaluate(r.normalized()).gradient / r.norm();
        };
        const auto numeric = difference(gradient, d, axis, 5e-4);
        for (int other = 0; other < 3; ++other)
          EXPECT_LT(
              (jets.hessian.col(kHessianColumn[axis][other]) - numeric.col(other)).cwiseAbs().maxCoeff(),
              1e-6)
              << order << " at " << d.transpose();
      }
    }
  }
}

TEST(DerivativeBasis, GradientIsTangentAndLaplacianIsAnEigenvalue) {
  const int order = 30;
  const DerivativeBasis derivatives(order);
  for (const Vec3& d : test_directions(20)) {
    const BasisJets jets = derivatives.evaluate(d);
    EXPECT_LT((jets.gradient * d).cwiseAbs().maxCoeff(), 1e-10);
    for (int l = 0; l <= order; ++l) {
      for (int j = index(l, -l); j <= index(l, l); ++j)
        ASSERT_NEAR(jets.hessian.row(j).head<3>().sum(), -l * (l + 1.0) * jets.value[j], 1e-8);
    }
  }
}

TEST(DerivativeBasis, InvalidInput) {
  EXPECT_THROW(RaisingOperators(-1), std::logic_error);
  EXPECT_THROW(RaisingOperators{kMaxOrder}, std::logic_error);
  EXPECT_THROW(DerivativeBasis(-1), std::logic_error);
  EXPECT_THROW(DerivativeBasis(kMaxOrder - 1), std::logic_error);
  EXPECT_THROW((void)RaisingOperators(2).apply(0, Eigen::MatrixXd::Zero(9, 1)), std::logic_error);
  EXPECT_THROW((void)RaisingOperators(2).apply(3, Eigen::MatrixXd::Zero(16, 1)), std::logic_error);
}

}  // namespace
}  // namespace vrc::sh
