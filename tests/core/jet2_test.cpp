// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/jet2.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "core/simd.h"

namespace vrc {
namespace {

/// c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2 + cubic terms that no second derivative at 0 sees.
struct Polynomial {
  std::array<double, 10> c;

  double operator()(const Vec2& d) const {
    const double x = d.x(), y = d.y();
    return c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y + c[6] * x * x * x +
           c[7] * x * x * y + c[8] * x * y * y + c[9] * y * y * y;
  }
  UnitJet<double> jet() const {
    return unit_jet<double>(1.0 / c[0], c[1], c[2], 2.0 * c[3], c[4], 2.0 * c[5]);
  }
};

class Polynomials {
 public:
  Polynomial next() {
    Polynomial p;
    for (double& c : p.c) c = coefficient_(random_);
    p.c[0] = 1.0 + std::abs(p.c[0]);
    return p;
  }

 private:
  std::mt19937_64 random_{42};
  std::uniform_real_distribution<double> coefficient_{-2.0, 2.0};
};

template <typename Function>
UnitJet<double> central_differences(const Function& f) {
  const auto at_step = [&](double h) -> std::array<double, 5> {
    const auto at = [&](double x, double y) { return f(Vec2(x * h, y * h)); };
    return {(at(1, 0) - at(-1, 0)) / (2 * h), (at(0, 1) - at(0, -1)) / (2 * h),
            (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / (h * h),
            (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h),
            (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / (h * h)};
  };
  const auto coarse = at_step(2e-3), fine = at_step(1e-3);
  std::array<double, 5> r{};
  for (std::size_t i = 0; i < 5; ++i) r[i] = (4 * fine[i] - coarse[i]) / 3;  // Richardson
  return unit_jet<double>(1.0 / f(Vec2(0, 0)), r[0], r[1], r[2], r[3], r[4]);
}

void expect_close(const UnitJet<double>& a, const UnitJet<double>& b) {
  const double scale =
      1.0 + std::abs(b.g1) + std::abs(b.g2) + std::abs(b.h11) + std::abs(b.h12) + std::abs(b.h22);
  EXPECT_NEAR(a.g1, b.g1, 1e-8 * scale);
  EXPECT_NEAR(a.g2, b.g2, 1e-8 * scale);
  EXPECT_NEAR(a.h11, b.h11, 1e-8 * scale);
  EXPECT_NEAR(a.h12, b.h12, 1e-8 * scale);
  EXPECT_NEAR(a.h22, b.h22, 1e-8 * scale);
}

TEST(UnitJet, ProductMatchesFiniteDifferences) {
  Polynomials polynomials;
  for (int i = 0; i < 50; ++i) {
    const Polynomial f = polynomials.next(), g = polynomials.next();
    expect_close(f.jet() * g.jet(), central_differences([&](const Vec2& d) { return f(d) * g(d); }));
  }
}

TEST(UnitJet, PowerMatchesFiniteDifferences) {
  Polynomials polynomials;
  for (const float p : {-4.0f, -2.0f, -1.0f, -0.5f, 0.5f, 1.0f, 2.0f, 7.5f}) {
    for (int i = 0; i < 10; ++i) {
      const Polynomial f = polynomials.next();
      expect_close(pow(f.jet(), p), central_differences([&](const Vec2& d) {
                     return std::pow(f(d), static_cast<double>(p));
                   }));
    }
  }
}

TEST(UnitJet, WeightedSumMatchesFiniteDifferences) {
  Polynomials polynomials;
  for (int i = 0; i < 50; ++i) {
    const Polynomial f = polynomials.next();
    Polynomial g = polynomials.next();
    if (i % 2 == 0) {
      for (double& c : g.c) c *= -0.25;  // a difference
    }
    expect_close(weighted_sum<double>(f.c[0], f.jet(), g.c[0], g.jet()),
                 central_differences([&](const Vec2& d) { return f(d) + g(d); }));
  }
}

TEST(UnitJet, SixteenLanesAgreeWithDouble) {
  Polynomials polynomials;
  const Polynomial f = polynomials.next(), g = polynomials.next();
  const auto lanes = [](const UnitJet<double>& j) -> UnitJet<F16> {
    const auto s = [](double v) { return splat(static_cast<float>(v)); };
    return {s(j.g1), s(j.g2), s(j.h11), s(j.h12), s(j.h22)};
  };
  const UnitJet<F16> product = lanes(f.jet()) * pow(lanes(g.jet()), -3.0f);
  const UnitJet<double> expected = f.jet() * pow(g.jet(), -3.0f);
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_NEAR(product.g1[i], expected.g1, 1e-5);
    EXPECT_NEAR(product.h12[i], expected.h12, 1e-4);
    EXPECT_NEAR(product.h22[i], expected.h22, 1e-4);
  }
}

TEST(TiltingJet, GoesAlongASurfaceAndBack) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> entry(-2.0, 2.0);
  TiltingJet<double> j;
  for (double* e : {&j.moved.g1, &j.moved.g2, &j.moved.h11, &j.moved.h12, &j.moved.h22, &j.n1, &j.n2, &j.x11,
                    &j.x12, &j.x21, &j.x22, &j.m11, &j.m12, &j.m22})
    *e = entry(random);
  const double s11 = entry(random), s12 = entry(random), s22 = entry(random);
  const TiltingJet<double> along = along_surface(j, s11, s12, s22);
  EXPECT_GT(std::abs(along.moved.h11 - j.moved.h11), 0.1);
  const TiltingJet<double> back = along_surface(along, -s11, -s12, -s22);
  expect_close(back.moved, j.moved);
  for (const auto& [a, b] : {std::pair(back.n1, j.n1),
                             {back.n2, j.n2},
                             {back.x11, j.x11},
                             {back.x12, j.x12},
                             {back.x21, j.x21},
                             {back.x22, j.x22},
                             {back.m11, j.m11},
                             {back.m22, j.m22}})
    EXPECT_NEAR(a, b, 1e-12);
}

TEST(Jet2, ExtrapolatesByOrder) {
  Jet2 jet;
  jet.value = 3.0;
  jet.gradient = Vec2(1.0, -2.0);
  jet.hessian << 4.0, 0.5, 0.5, -6.0;
  const Vec2 d(0.5, 2.0);
  EXPECT_DOUBLE_EQ(jet.extrapolate(d, 0), 3.0);
  EXPECT_DOUBLE_EQ(jet.extrapolate(d, 1), 3.0 + 0.5 - 4.0);
  EXPECT_DOUBLE_EQ(jet.extrapolate(d), -0.5 + 0.5 * (4.0 * 0.25 + 2.0 * 0.5 * 0.5 * 2.0 - 6.0 * 4.0));
  EXPECT_DOUBLE_EQ(jet.extrapolate(Vec2::Zero()), 3.0);
}

TEST(Jet2, ReproducesAQuadraticExactly) {
  Polynomials polynomials;
  Polynomial p = polynomials.next();
  for (std::size_t i = 6; i < 10; ++i) p.c[i] = 0.0;
  Jet2 jet;
  jet.value = p.c[0];
  jet.gradient = Vec2(p.c[1], p.c[2]);
  jet.hessian << 2 * p.c[3], p.c[4], p.c[4], 2 * p.c[5];
  for (const Vec2& d : {Vec2(1, 0), Vec2(0, -3), Vec2(2, 5), Vec2(-0.1, 0.7)}) {
    EXPECT_NEAR(jet.extrapolate(d), p(d), 1e-12);
  }
}

}  // namespace
}  // namespace vrc
