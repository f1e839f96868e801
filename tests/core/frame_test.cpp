// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/frame.h"

#include <gtest/gtest.h>

#include <random>

namespace vrc {
namespace {

void expect_right_handed(const Vec3& n) {
  const Frame frame = Frame::around(n);
  EXPECT_EQ(frame.normal, n);
  EXPECT_NEAR(frame.tangent.norm(), 1.0, 1e-14) << n.transpose();
  EXPECT_NEAR(frame.bitangent.norm(), 1.0, 1e-14) << n.transpose();
  EXPECT_NEAR(frame.tangent.dot(n), 0.0, 1e-14) << n.transpose();
  EXPECT_LT((frame.tangent.cross(frame.bitangent) - n).norm(), 1e-14) << n.transpose();
}

TEST(Frame, AroundRandomNormals) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10000; ++i) {
    const double flatness = i % 2 == 0 ? 1.0 : 1e-7;  // half of them close to the z axis
    expect_right_handed(
        Vec3(flatness * normal(random), flatness * normal(random), normal(random)).normalized());
  }
}

TEST(Frame, AroundAxesAndBothSidesOfTheSeam) {
  for (int axis = 0; axis < 3; ++axis) {
    expect_right_handed(Vec3::Unit(axis));
    expect_right_handed(-Vec3::Unit(axis));
  }
  for (const double z : {0.0, -0.0, 1e-300, -1e-300, 1e-12, -1e-12}) {
    expect_right_handed(Vec3(0.6, -0.8, z));
    expect_right_handed(Vec3(-1.0, 0.0, z));
  }
}

}  // namespace
}  // namespace vrc
