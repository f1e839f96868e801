// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/rotation.h"

#include <gtest/gtest.h>

#include "sh/frame_rotator.h"
#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

constexpr int kOrder = 30;

double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

/// Random frames, the half turns and quarter turns, and normals almost at the poles.
std::vector<Mat3> test_rotations() {
  test::ShRandom random(31);
  std::vector<Mat3> result = {Mat3::Identity()};
  for (int i = 0; i < 10; ++i) result.push_back(random.rotation());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double angle : {0.5 * kPi, kPi, -0.5 * kPi, 1e-9})
      result.emplace_back(Eigen::AngleAxisd(angle, Vec3::Unit(axis)));
  }
  for (const double tilt : {1e-3, 1e-8, 1e-17, kPi - 1e-8}) {
    result.emplace_back(Eigen::AngleAxisd(0.7, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt, Vec3::UnitY()) *
                        Eigen::AngleAxisd(-2.0, Vec3::UnitZ()));
  }
  return result;
}

TEST(Rotation, TurnsTheFunction) {
  test::ShRandom random(32);
  const Eigen::VectorXd c = random.coefficients(kOrder);
  for (const Mat3& r : test_rotations()) {
    const Eigen::VectorXd turned = Rotation(kOrder, r).apply(c);
    for (int i = 0; i < 5; ++i) {
      const Vec3 d = random.direction();
      EXPECT_NEAR(test::function_value(turned, r * d), test::function_value(c, d), 1e-11);
    }
  }
}

TEST(Rotation, IdentityInverseAndComposition) {
  test::ShRandom random(33);
  const Eigen::VectorXd c = random.coefficients(kOrder);
  const Mat3 r = random.rotation(), s = random.rotation();
  const Rotation of_r(kOrder, r), of_s(kOrder, s);
  EXPECT_LT(distance(Rotation(kOrder, Mat3::Identity()).apply(c), c), 1e-13);
  EXPECT_LT(distance(Rotation(kOrder, r.transpose()).apply(of_r.apply(c)), c), 1e-12);
  EXPECT_LT(distance(Rotation(kOrder, s * r).apply(c), of_s.apply(of_r.apply(c))), 1e-12);
}

TEST(Rotation, BandsAreOrthogonal) {
  for (const Mat3& r : test_rotations()) {
    const Rotation rotation(kOrder, r);
    for (int l = 0; l <= kOrder; ++l) {
      const Eigen::MatrixXd& band = rotation.band(l);
      ASSERT_EQ(band.rows(), 2 * l + 1);
      ASSERT_LT(distance(band.transpose() * band, Eigen::MatrixXd::Identity(2 * l + 1, 2 * l + 1)), 1e-12);
    }
  }
}

TEST(Rotation, InvalidInput) {
  EXPECT_THROW(Rotation(-1, Mat3::Identity()), std::logic_error);
  EXPECT_THROW(Rotation(3, -Mat3::Identity()), std::logic_error);
  EXPECT_THROW(Rotation(3, 1.1 * Mat3::Identity()), std::logic_error);
  EXPECT_THROW((void)Rotation(1, Mat3::Identity()).apply(Eigen::VectorXd::Zero(9)), std::logic_error);
  EXPECT_EQ(Rotation(0, Mat3::Identity()).apply(Eigen::MatrixXd::Constant(1, 1, 3.0))(0, 0), 3.0);
}

TEST(FrameRotator, AgreesWithTheMatrices) {
  test::ShRandom random(34);
  for (const int order : {0, 1, 2, 3, 10, 24, kMaxFrameOrder}) {
    const FrameRotator rotator(order);
    Eigen::MatrixXd c(coefficient_count(order), 2);
    c << random.coefficients(order), random.coefficients(order);
    const Eigen::MatrixXf local = c.cast<float>();
    Eigen::MatrixXf world(local.rows(), 2), back(local.rows(), 2);
    for (const Mat3& r : test_rotations()) {
      const Frame frame = {r.col(0), r.col(1), r.col(2)};
      rotator.rotate(frame, local, world);
      const Eigen::MatrixXd expected = Rotation(order, r).apply(local.cast<double>());
      EXPECT_LT(distance(world.cast<double>(), expected), 2e-6 * c.norm()) << order << '\n' << r;
      for (int l = 0; l <= order; ++l) {
        const auto band = [l](const Eigen::MatrixXf& m) {
          return m.col(0).segment(index(l, -l), 2 * l + 1).norm();
        };
        EXPECT_NEAR(band(world), band(local), 1e-5f * band(local));
      }
      rotator.rotate(transposed(frame), world, back);
      EXPECT_LT(distance(back.cast<double>(), c), 4e-6 * c.norm());
    }
  }
}

TEST(FrameRotator, KeepsTheValueAlongTheNormal) {
  test::ShRandom random(35);
  const Eigen::VectorXd c = random.coefficients(12);
  Eigen::VectorXf world(c.size());
  for (const Vec3& n : test::test_directions(20)) {
    const Frame frame = Frame::around(n);
    FrameRotator(12).rotate(frame, c.cast<float>(), world);
    EXPECT_NEAR(test::function_value(world.cast<double>(), n), test::function_value(c, Vec3::UnitZ()), 1e-4);
  }
}

TEST(FrameRotator, InvalidInput) {
  EXPECT_THROW(FrameRotator(-1), std::logic_error);
  EXPECT_THROW(FrameRotator(kMaxFrameOrder + 1), std::logic_error);
  Eigen::MatrixXf nine(9, 1), four(4, 1);
  nine.setZero();
  EXPECT_THROW(FrameRotator(2).rotate({}, nine, four), std::logic_error);
  EXPECT_THROW(FrameRotator(1).rotate({}, nine, nine), std::logic_error);
}

}  // namespace
}  // namespace vrc::sh
