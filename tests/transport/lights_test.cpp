// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/lights.h"

#include <gtest/gtest.h>

#include "statistics.h"
#include "transport/bsdf.h"

namespace vrc {
namespace {

EmissiveTriangle triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Rgb& radiance) {
  EmissiveTriangle t;
  t.p0 = a;
  t.e1 = b - a;
  t.e2 = c - a;
  const Vec3f cross = t.e1.cross(t.e2);
  t.area = 0.5f * cross.norm();
  t.normal = cross.normalized();
  t.radiance = radiance;
  return t;
}

/// Above the origin, facing down.
EmissiveTriangle ceiling(float height, float radiance) {
  return triangle({-1, -1, height}, {0, 1, height}, {1, -1, height}, Rgb::Constant(radiance));
}

const V3x16 kOrigin{};
const V3x16 kUp = splat3(Vec3(Vec3::UnitZ()));

/// Calls body(sample, lane) for many samples.
template <typename Body>
void draw(const Lights& lights, const V3x16& position, const V3x16& n, const Body& body, int packets = 2000) {
  Random random(9);
  for (int packet = 0; packet < packets; ++packet) {
    const F16 u1 = random.uniform16(), u2 = random.uniform16();
    const LightSample16 s = lights.sample(position, n, u1, u2);
    for (int i = 0; i < kLanes; ++i) body(s, i);
  }
}

/// Irradiance by sampling, through the cosine at a surface that faces up.
Estimate irradiance(const Lights& lights) {
  Estimate result;
  draw(lights, kOrigin, kUp, [&](const LightSample16& s, int i) {
    result.add(s.valid[i] != 0 ? s.radiance.y[i] * std::max(0.0f, s.direction.z[i]) : 0.0);
  });
  return result;
}

TEST(Lights, WithoutLightsNothingArrives) {
  const Lights none;
  EXPECT_TRUE(none.empty());
  EXPECT_FALSE(any(none.sample(kOrigin, kUp, splat(0.5f), splat(0.5f)).valid));
  const Lights black({ceiling(1, 0)}, {PointLight{Vec3::UnitZ(), Rgb::Zero()}}, Rgb::Zero(), 1.0);
  EXPECT_TRUE(black.empty());
  EXPECT_FALSE(any(black.sample(kOrigin, kUp, splat(0.5f), splat(0.5f)).valid));
}

TEST(Lights, PointLightFallsWithTheSquareOfTheDistance) {
  const Lights lights({}, {PointLight{Vec3(0, 3, 4), Rgb(1, 2, 3)}}, Rgb::Zero(), 10.0);
  const LightSample16 s = lights.sample(kOrigin, kUp, splat(0.7f), splat(0.1f));
  EXPECT_TRUE(all(s.valid));
  EXPECT_NEAR(s.distance[0], 5.0f, 1e-5f);
  EXPECT_LT((lane(s.direction, 4) - Vec3(0, 0.6, 0.8)).norm(), 1e-6);
  EXPECT_LT((lane(s.radiance, 4) - Vec3(1, 2, 3) / 25.0).norm(), 1e-6);
  EXPECT_EQ(s.pdf[0], 0.0f) << "no BSDF sample can meet it";
}

TEST(Lights, DirectionalLightArrivesAgainstItsDirection) {
  const Vec3 travel = Vec3(1, 2, -2) / 3.0;
  const Lights lights({}, {DirectionalLight{travel, Rgb(4, 5, 6)}}, Rgb::Zero(), 10.0);
  const LightSample16 s = lights.sample(kOrigin, kUp, splat(0.2f), splat(0.9f));
  EXPECT_TRUE(all(s.valid));
  EXPECT_LT((lane(s.direction, 2) + travel).norm(), 1e-6);
  EXPECT_LT((lane(s.radiance, 2) - Vec3(4, 5, 6)).norm(), 1e-5);
  EXPECT_GT(s.distance[0], 20.0f) << "beyond the scene";
  EXPECT_EQ(s.pdf[0], 0.0f);
}

TEST(Lights, ConstantEnvironmentGivesPiTimesItsRadiance) {
  const Lights lights({}, {}, Rgb::Constant(0.7f), 2.0);
  draw(
      lights, kOrigin, kUp,
      [](const LightSample16& s, int i) {
        if (s.valid[i] == 0) return;
        ASSERT_NEAR(s.radiance.x[i] * s.direction.z[i], 0.7f * kPiF, 1e-3f)
            << "cosine-distributed: no variance";
        ASSERT_GT(s.distance[i], 4.0f);
      },
      100);
  EXPECT_NEAR(irradiance(lights).mean(), 0.7 * kPi, 1e-3);
}

TEST(Lights, TriangleIrradianceIsLambertsFormula) {
  const EmissiveTriangle t = triangle({-1, -1, 2}, {0, 1, 2}, {1, -1, 2.5f}, Rgb::Constant(1.5f));
  // E = L/2 sum over edges of the angle it spans times the cosine of its plane's normal.
  const Vec3 p[3] = {t.p0.cast<double>(), (t.p0 + t.e1).cast<double>(), (t.p0 + t.e2).cast<double>()};
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = p[k].normalized(), b = p[(k + 1) % 3].normalized(), cross = a.cross(b);
    sum += std::acos(a.dot(b)) * cross.normalized().z();
  }
  const Estimate e = irradiance(Lights({t}, {}, Rgb::Zero(), 3.0));
  EXPECT_LT(std::abs(z_score(e, 1.5 / 2.0 * std::abs(sum))), 4.0)
      << e.mean() << " against " << 0.75 * std::abs(sum);
}

TEST(Lights, SeveralKindsAddUp) {
  const std::vector<EmissiveTriangle> triangles = {ceiling(2, 1), ceiling(3, 5)};
  const std::vector<DeltaLight> deltas = {PointLight{Vec3(0, 0, 2), Rgb::Constant(3.0f)},
                                          DirectionalLight{-Vec3::UnitZ(), Rgb::Constant(0.5f)}};
  const double separate = irradiance(Lights({triangles[0]}, {}, Rgb::Zero(), 3.0)).mean() +
                          irradiance(Lights({triangles[1]}, {}, Rgb::Zero(), 3.0)).mean() + 3.0 / 4.0 + 0.5 +
                          kPi * 0.2;
  const Estimate together = irradiance(Lights(triangles, deltas, Rgb::Constant(0.2f), 3.0));
  EXPECT_NEAR(together.mean(), separate, 4.0 * together.error() + 0.02);
}

TEST(Lights, AreChosenByPower) {
  // Equal areas, radiances 1 and 3; a point light of the same power as the second.
  const float area = 2.0f;
  const Lights lights({ceiling(2, 1), ceiling(4, 3)},
                      {PointLight{Vec3(0, 0, 9), Rgb::Constant(3.0f * area / 4.0f)}}, Rgb::Zero(), 9.0);
  std::array<int, 3> chosen{};
  draw(lights, kOrigin, kUp, [&](const LightSample16& s, int i) {
    const double height = s.distance[i] * s.direction.z[i];
    ++chosen[height < 3.0 ? 0 : height < 6.0 ? 1 : 2];
  });
  const double total = chosen[0] + chosen[1] + chosen[2];
  EXPECT_NEAR(chosen[0] / total, 1.0 / 7.0, 0.01);
  EXPECT_NEAR(chosen[1] / total, 3.0 / 7.0, 0.01);
  EXPECT_NEAR(chosen[2] / total, 3.0 / 7.0, 0.01);
}

TEST(Lights, DensityOfASampleIsThatOfItsHit) {
  for (const std::size_t count : {std::size_t{2}, std::size_t{40}}) {
    std::vector<EmissiveTriangle> stack;  // tell them apart by height
    for (std::size_t i = 0; i < count; ++i) {
      stack.push_back(ceiling(1.0f + static_cast<float>(i), 1.0f + static_cast<float>(i % 3)));
    }
    const Lights lights(stack, {}, Rgb::Zero(), 3.0);
    draw(
        lights, kOrigin, kUp,
        [&](const LightSample16& s, int i) {
          const auto index = static_cast<std::int32_t>(std::lround(s.distance[i] * s.direction.z[i])) - 1;
          const F16 pdf = lights.pdf_of_hit(splat(-1), splat(index), s.direction, s.distance);
          ASSERT_NEAR(s.pdf[i] / pdf[i], 1.0f, 1e-4f);
          ASSERT_NEAR(s.radiance.x[i] * s.pdf[i], 1.0f + static_cast<float>(index % 3), 1e-4f);
        },
        100);
  }
  const Lights sky({}, {}, Rgb::Ones(), 3.0);
  draw(
      sky, kOrigin, kUp,
      [&](const LightSample16& s, int i) {
        ASSERT_NEAR(s.pdf[i], sky.pdf_of_environment(s.direction.z)[i], 1e-6f);
      },
      100);
}

TEST(Lights, EmitOnTheSideOfTheNormalOnly) {
  const Lights lights({ceiling(1, 2)}, {}, Rgb::Zero(), 3.0);
  const I16 first = splat(0);
  EXPECT_EQ(lights.emitted(splat(-1), first, splat3(Vec3(0, 0.6, 0.8))).x[0], 2.0f);
  EXPECT_EQ(lights.emitted(splat(-1), first, splat3(Vec3(0, 0.6, -0.8))).x[0], 0.0f);
  const V3x16 above = splat3(Vec3(0, 0, 5));
  EXPECT_FALSE(any(lights.sample(above, -kUp, splat(0.3f), splat(0.6f)).valid));
  EXPECT_EQ(lights.emitted(I16{}, first, kUp).x[3], 0.0f) << "inactive";
}

TEST(Lights, ExtremeNumbersChooseALight) {
  std::vector<EmissiveTriangle> many;
  for (int i = 0; i < 100; ++i) many.push_back(ceiling(1.0f + static_cast<float>(i), 1e-3f));
  for (const Lights& lights : {Lights({ceiling(1, 1), ceiling(2, 1e-6f)}, {}, Rgb::Ones(), 3.0),
                               Lights(many, {}, Rgb::Zero(), 3.0)}) {
    for (const float u : {0.0f, 0x1p-24f, 0.5f, 0x1.fffffep-1f}) {
      const LightSample16 s = lights.sample(kOrigin, kUp, splat(u), splat(1.0f - 0x1p-24f));
      EXPECT_TRUE(std::isfinite(s.radiance.x[0]) && std::isfinite(s.pdf[0])) << u;
      EXPECT_NEAR(lane(s.direction, 0).norm(), 1.0, 1e-5) << u;
    }
  }
}

}  // namespace
}  // namespace vrc
