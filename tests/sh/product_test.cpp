// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/product.h"

#include <gtest/gtest.h>

#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

TEST(Product, IsThePointwiseProduct) {
  test::ShRandom random(21);
  const Eigen::VectorXd a = random.coefficients(5), b = random.coefficients(8);
  const Eigen::VectorXd c = Product(5, 8, 13)(a, b);
  ASSERT_EQ(c.size(), coefficient_count(13));
  for (const Vec3& d : test::test_directions(50))
    EXPECT_NEAR(test::function_value(c, d), test::function_value(a, d) * test::function_value(b, d), 1e-11);
}

TEST(Product, LowerOrdersAreItsFirstBands) {
  test::ShRandom random(22);
  const Eigen::VectorXd a = random.coefficients(6), b = random.coefficients(3);
  const Eigen::VectorXd all = Product(6, 3, 9)(a, b), some = Product(6, 3, 4)(a, b);
  EXPECT_LT((all.head(some.size()) - some).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Product, ByAConstantAndOrderZero) {
  test::ShRandom random(23);
  const Eigen::VectorXd a = random.coefficients(10);
  const Eigen::VectorXd one = Eigen::VectorXd::Constant(1, std::sqrt(4.0 * kPi));
  EXPECT_LT((Product(10, 0, 10)(a, one) - a).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(Product(0, 0, 0)(one, one)[0], one[0], 1e-14);
  // The mean of a product is the inner product.
  EXPECT_NEAR(Product(10, 10, 0)(a, a)[0] * one[0], a.squaredNorm(), 1e-10);
}

TEST(Product, InvalidInput) {
  EXPECT_THROW(Product(-1, 2, 2), std::logic_error);
  EXPECT_THROW(Product(2, 2, kMaxOrder + 1), std::logic_error);
  const Product product(2, 1, 3);
  EXPECT_THROW((void)product(Eigen::VectorXd::Zero(9), Eigen::VectorXd::Zero(9)), std::logic_error);
}

}  // namespace
}  // namespace vrc::sh
