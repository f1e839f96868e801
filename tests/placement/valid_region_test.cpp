// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/valid_region.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support.h"

namespace vrc {
namespace {

constexpr double kNoMaximum = 1e9;

Jet2 jet(const Vec2& gradient, const Mat2& hessian) {
  Jet2 j;
  j.value = 1.0;
  j.gradient = gradient;
  j.hessian = hessian;
  return j;
}

Mat2 symmetric(double a, double b, double c) {
  Mat2 m;
  m << a, b, b, c;
  return m;
}

double radius_of(double epsilon, double reference, double eigenvalue) {
  return std::sqrt(std::sqrt(4.0 * epsilon * reference / (kPi * eigenvalue)));
}

void expect_parallel(const Vec2& a, const Vec2& b) { EXPECT_NEAR(std::abs(a.dot(b)), 1.0, 1e-9); }

TEST(HessianRadii, FollowEquation4ForADiagonalHessian) {
  const RegionAxes axes = hessian_radii(jet({5, 3}, symmetric(-16, 0, 2)), 0.5, 1e-3, 0.0, kNoMaximum);
  // The long axis comes first: it belongs to the smaller |eigenvalue|.
  expect_parallel(axes.axis1, {0, 1});
  expect_parallel(axes.axis2, {1, 0});
  EXPECT_NEAR(axes.radius1, radius_of(1e-3, 0.5, 2), 1e-12);
  EXPECT_NEAR(axes.radius2, radius_of(1e-3, 0.5, 16), 1e-12);
  EXPECT_NEAR(axes.radius1 / axes.radius2, std::pow(8.0, 0.25), 1e-12);
}

TEST(HessianRadii, FollowTheEigenvectorsOfARotatedHessian) {
  const double angle = 0.7;
  const Vec2 u(std::cos(angle), std::sin(angle)), v(-std::sin(angle), std::cos(angle));
  const Mat2 h = 9.0 * u * u.transpose() - 4.0 * v * v.transpose();
  const RegionAxes axes = hessian_radii(jet({0, 0}, h), 2.0, 1e-4, 1.0, kNoMaximum);
  expect_parallel(axes.axis1, v);
  expect_parallel(axes.axis2, u);
  EXPECT_NEAR(axes.radius1, radius_of(1e-4, 2.0, 4), 1e-12);
  EXPECT_NEAR(axes.radius2, radius_of(1e-4, 2.0, 9), 1e-12);
}

TEST(HessianRadii, TakeTheGradientsShareInItsDirection) {
  // |H| + share g g^T / L = diag(3, 7) + share diag(4 / 0.5, 0)
  const RegionAxes axes = hessian_radii(jet({2, 0}, symmetric(3, 0, -7)), 0.5, 1e-3, 1.0, kNoMaximum);
  expect_parallel(axes.axis2, {1, 0});
  EXPECT_NEAR(axes.radius2, radius_of(1e-3, 0.5, 11), 1e-12);
  EXPECT_NEAR(axes.radius1, radius_of(1e-3, 0.5, 7), 1e-12);
  const RegionAxes half = hessian_radii(jet({2, 0}, symmetric(3, 0, -7)), 0.5, 1e-3, 0.25, kNoMaximum);
  EXPECT_NEAR(half.radius1, radius_of(1e-3, 0.5, 5), 1e-12);
  EXPECT_NEAR(half.radius2, radius_of(1e-3, 0.5, 7), 1e-12);
}

TEST(HessianRadii, DoNotExceedTheirMaximum) {
  const RegionAxes flat = hessian_radii(jet({0, 0}, Mat2::Zero()), 1.0, 1e-3, 1.0, 0.25);
  EXPECT_EQ(flat.radius1, 0.25);
  EXPECT_EQ(flat.radius2, 0.25);
  const RegionAxes ridge = hessian_radii(jet({0, 0}, symmetric(1e4, 0, 0)), 1.0, 1e-3, 1.0, 0.25);
  EXPECT_EQ(ridge.radius1, 0.25);
  EXPECT_NEAR(ridge.radius2, radius_of(1e-3, 1.0, 1e4), 1e-12);
}

TEST(HessianRadii, ScaleWithTheScene) {
  // In another unit of length, k times smaller: epsilon in length^2, derivatives per length.
  const double k = 1000.0;
  const Jet2 metres = jet({0.3, -0.8}, symmetric(2, 1, -3));
  const Jet2 millimetres = jet(metres.gradient / k, metres.hessian / (k * k));
  const RegionAxes a = hessian_radii(metres, 0.7, 1e-3, 1.0, kNoMaximum);
  const RegionAxes b = hessian_radii(millimetres, 0.7, 1e-3 * k * k, 1.0, kNoMaximum);
  EXPECT_NEAR(b.radius1 / a.radius1, k, 1e-6 * k);
  EXPECT_NEAR(b.radius2 / a.radius2, k, 1e-6 * k);
}

double inverse_square(const RegionAxes& axes, const Vec2& direction) {
  return std::pow(direction.dot(axes.axis1) / axes.radius1, 2) +
         std::pow(direction.dot(axes.axis2) / axes.radius2, 2);
}

TEST(Intersection, AddsTheInverseSquaresInEveryDirection) {
  const double a1 = 0.4, a2 = 1.1;
  const RegionAxes axes = {{std::cos(a1), std::sin(a1)}, {-std::sin(a1), std::cos(a1)}, 0.3, 0.1};
  const Vec2 wall(std::cos(a2), std::sin(a2)), along(-wall[1], wall[0]);
  const RegionAxes both = intersection(axes, wall, 0.05, 0.2);
  for (int i = 0; i < 16; ++i) {
    const Vec2 d(std::cos(0.4 * i), std::sin(0.4 * i));
    const double limits = std::pow(d.dot(wall) / 0.05, 2) + std::pow(d.dot(along) / 0.2, 2);
    EXPECT_NEAR(inverse_square(both, d), inverse_square(axes, d) + limits, 1e-9 * inverse_square(both, d));
  }
  EXPECT_GE(both.radius1, both.radius2);
}

ValidRegion tilted_region() {
  ValidRegion r;
  r.center = {1, 2, 3};
  r.normal = Vec3(1, 2, 2) / 3.0;
  r.axis1 = Vec3(2, 1, -2) / 3.0;
  r.axis2 = Vec3(2, -2, 1) / 3.0;
  r.radius1 = 0.4;
  r.radius2 = 0.1;
  r.normal_radius = 0.1;
  r.cos_max_deviation = std::cos(0.1);
  return r;
}

TEST(Weight, FollowsEquations14And15WithTheAngleInTheDistance) {
  const ValidRegion r = tilted_region();
  // 0.5 and 0.5 of the radii along the axes, 0.1 of it along the normal.
  const Vec3 x = r.center + 0.2 * r.axis1 - 0.05 * r.axis2 + 0.01 * r.normal;
  const double kt = std::sqrt(0.25 + 0.25 + 0.01);
  EXPECT_NEAR(translation_distance(r, x), kt, 1e-12);
  EXPECT_NEAR(weight(r, x, r.normal), 1.0 - kt, 1e-12);
  const double angle = 0.06, kr = std::cos(angle), turn = (1.0 - kr) / (1.0 - std::cos(0.1));
  EXPECT_NEAR(turn, 0.36, 1e-3) << "(angle / theta_max)^2";
  const Vec3 n = kr * r.normal + std::sin(angle) * r.axis1;
  const double k = std::sqrt(kt * kt + turn), wide = std::sqrt(0.25 * kt * kt + turn);
  EXPECT_NEAR(joint_distance(r, x, n), k, 1e-12);
  EXPECT_NEAR(weight(r, x, n), (1.0 - k * kr) * std::pow(kr, 16), 1e-12);
  EXPECT_NEAR(weight(r, x, n, 2.0), (1.0 - wide * kr) * std::pow(kr, 16), 1e-12);
}

TEST(Weight, IsThatOfThePaperWhereNormalsDoNotCount) {
  ValidRegion r = tilted_region();
  r.normals_count = false;
  const Vec3 x = r.center + 0.2 * r.axis1, n = std::cos(0.06) * r.normal + std::sin(0.06) * r.axis1;
  EXPECT_NEAR(joint_distance(r, x, n), 0.5, 1e-12);
  const double kr = std::cos(0.06);
  EXPECT_NEAR(weight(r, x, n), (1.0 - 0.5 * kr) * std::pow(kr, 16), 1e-12);
  EXPECT_EQ(weight(r, x, std::cos(0.11) * r.normal + std::sin(0.11) * r.axis1), 0.0);
}

TEST(Weight, IsZeroOutsideTheEllipsoidAndBeyondTheLargestAngle) {
  const ValidRegion r = tilted_region();
  EXPECT_EQ(weight(r, r.center, r.normal), 1.0);
  EXPECT_EQ(weight(r, r.center + 0.401 * r.axis1, r.normal), 0.0);
  EXPECT_GT(weight(r, r.center + 0.399 * r.axis1, r.normal), 0.0);
  EXPECT_EQ(weight(r, r.center + 0.101 * r.axis2, r.normal), 0.0);
  EXPECT_EQ(weight(r, r.center + 0.101 * r.normal, r.normal), 0.0);
  const auto turned = [&](double angle) -> Vec3 {
    return std::cos(angle) * r.normal + std::sin(angle) * r.axis2;
  };
  EXPECT_GT(weight(r, r.center, turned(0.099)), 0.0);
  EXPECT_EQ(weight(r, r.center, turned(0.101)), 0.0);
  EXPECT_EQ(weight(r, r.center, -r.normal), 0.0);
}

}  // namespace
}  // namespace vrc
