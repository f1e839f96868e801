// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/coordinate_operators.h"

#include <gtest/gtest.h>

#include "sh/derivatives.h"
#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

using test::harmonics;
using test::test_directions;

constexpr int kOrder = 20;
constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

TEST(CoordinateOperators, MultiplyByTheCoordinates) {
  const CoordinateOperators operators(kOrder);
  const Basis low(kOrder), high(kOrder + 1);
  for (const Vec3& d : test_directions(20)) {
    const Eigen::VectorXd y = harmonics(low, d), above = harmonics(high, d);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LT((operators.multiply[axis] * above - d[axis] * y).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(CoordinateOperators, DifferentiateOnceAndTwice) {
  const CoordinateOperators once(kOrder), twice(kOrder + 1);
  const DerivativeBasis basis(kOrder);
  const Basis high(kOrder + 2);
  for (const Vec3& d : test_directions(20)) {
    const BasisJets jets = basis.evaluate(d);
    const Eigen::VectorXd y = harmonics(high, d);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::VectorXd first = once.differentiate[axis] * y.head(coefficient_count(kOrder + 1));
      EXPECT_LT((first - jets.gradient.col(axis)).cwiseAbs().maxCoeff(), 1e-10);
    }
    for (int pair = 0; pair < 6; ++pair) {
      const auto [a, b] = kPairs[pair];
      const Eigen::VectorXd inner = twice.differentiate[b] * y - twice.multiply[b] * y;
      const Eigen::VectorXd second = once.differentiate[a] * inner;
      EXPECT_LT((second - jets.hessian.col(pair)).cwiseAbs().maxCoeff(), 1e-8);
    }
  }
}

TEST(CoordinateOperators, OfOrderZeroReadTheFirstBand) {
  const CoordinateOperators operators(0);
  EXPECT_EQ(operators.multiply[2].cols(), 4);
  EXPECT_NEAR(operators.multiply[2].coeff(0, index(1, 0)), 1.0 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(operators.differentiate[0].norm(), 0.0);  // Y_00 is constant
}

}  // namespace
}  // namespace vrc::sh
