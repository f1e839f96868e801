// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../placement/src/hemisphere_edges.h"

#include <gtest/gtest.h>

#include "support.h"

namespace vrc {
namespace {

/// Form factor of a triangle above the receiver at `x`, by Lambert's formula.
double form_factor(const std::array<Vec3, 3>& corners, const Vec2& x) {
  const Vec3 origin(x[0], x[1], 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 r = corners[i] - origin, q = corners[(i + 1) % 3] - origin, c = r.cross(q);
    sum += std::atan2(c.norm(), r.dot(q)) * c.z() / c.norm();
  }
  return sum / (2.0 * kPi);
}

TEST(HemisphereEdges, AddUpToTheDerivativesOfAFormFactor) {
  test::SeededBits bits(11);
  const auto number = [&] { return 2.0 * bits.uniform() - 1.0; };
  for (int run = 0; run < 50; ++run) {
    std::array<Vec3, 3> corners;
    for (Vec3& p : corners) p = Vec3(number(), number(), 0.3 + bits.uniform());
    Vec2 gradient = Vec2::Zero();
    Mat2 hessian = Mat2::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      const EdgeDerivatives edge = edge_derivatives(corners[i], corners[(i + 1) % 3]);
      gradient += edge.gradient;
      hessian += edge.hessian;
    }
    const double h = 1e-4;
    const auto f = [&](double a, double b) { return form_factor(corners, Vec2(a, b)); };
    EXPECT_NEAR(gradient[0], (f(h, 0) - f(-h, 0)) / (2 * h), 1e-6);
    EXPECT_NEAR(gradient[1], (f(0, h) - f(0, -h)) / (2 * h), 1e-6);
    EXPECT_NEAR(hessian(0, 0), (f(h, 0) - 2 * f(0, 0) + f(-h, 0)) / (h * h), 1e-5);
    EXPECT_NEAR(hessian(1, 1), (f(0, h) - 2 * f(0, 0) + f(0, -h)) / (h * h), 1e-5);
    EXPECT_NEAR(hessian(0, 1), (f(h, h) - f(h, -h) - f(-h, h) + f(-h, -h)) / (4 * h * h), 1e-5);
    EXPECT_NEAR(hessian(0, 1), hessian(1, 0), 1e-12);
  }
}

TEST(HemisphereEdges, OfNoLengthOrThroughTheReceiverAddNothing) {
  const Vec3 p(0.3, 0.2, 0.5);
  EXPECT_EQ(edge_derivatives(p, p).gradient.norm(), 0.0);
  EXPECT_EQ(edge_derivatives(p, 2.0 * p).hessian.norm(), 0.0);
}

}  // namespace
}  // namespace vrc
