// SPDX-License-Identifier: GPL-3.0-or-later
// Chi-square tests: every sampler's directions follow its density.
#include <gtest/gtest.h>

#include "scalar_lobes.h"
#include "statistics.h"
#include "transport/bsdf.h"
#include "transport/lights.h"

namespace vrc {
namespace {

/// Directions of one packet; lanes outside the mask made none.
struct Drawn {
  I16 valid;
  V3x16 direction;
};
using Sampler = std::function<Drawn(F16 u1, F16 u2)>;

constexpr int kPackets = 20000;
/// How many tests share the probability of a false alarm.
constexpr int kTests = 50;

ChiSquare test_sampler(const SphereGrid& grid, const Sampler& sampler, const DirectionFunction& density,
                       std::uint64_t seed, int parts = 16) {
  Random random(seed);
  std::vector<double> counts(grid.size());
  for (int packet = 0; packet < kPackets; ++packet) {
    const F16 u1 = random.uniform16(), u2 = random.uniform16();
    const Drawn drawn = sampler(u1, u2);
    for (int i = 0; i < kLanes; ++i) {
      if (drawn.valid[i] == 0) continue;
      const Vec3 w = lane(drawn.direction, i);
      EXPECT_NEAR(w.norm(), 1.0, 1e-5);
      ++counts[grid.cell(w)];
    }
  }
  return chi_square_test(counts, grid.integrals(density, parts), 1.0 * kPackets * kLanes);
}

void expect_fits(const ChiSquare& result) {
  EXPECT_GT(result.p_value, sidak_level(kTests))
      << "chi-square " << result.statistic << " with " << result.degrees << " degrees; density sums to "
      << result.total;
  EXPECT_GT(result.degrees, 30) << "too few cells to say anything";
  EXPECT_LT(result.total, 1.003);
}

/// In a frame of no special direction.
struct Outgoing {
  Vec3 n, wo;
  explicit Outgoing(double cosine) : n(Vec3(0.3, -0.8, -0.5).normalized()) {
    const Vec3 tangent = n.cross(Vec3(1, 0.2, 0.1)).normalized();
    wo = (cosine * n + std::sqrt(1.0 - cosine * cosine) * tangent).normalized();
  }
};

template <typename AnyLobe>
void test_lobe(const AnyLobe& lobe, double cosine, const SphereGrid& grid, std::uint64_t seed) {
  const Outgoing s(cosine);
  const V3x16 n = splat3(s.n), wo = splat3(s.wo);
  const auto sampler = [&](F16 u1, F16 u2) { return Drawn{splat(-1), sample(lobe, n, wo, u1, u2)}; };
  const auto density = [&](const V3x16& wi) { return pdf(lobe, directions(n, wo, wi)); };
  const ChiSquare result = test_sampler(grid, sampler, density, seed);
  expect_fits(result);
  EXPECT_NEAR(result.total, 1.0, 3e-3);
}

TEST(ChiSquare, RefusesAWrongDensityAndAcceptsTheRightOne) {
  const SphereGrid grid(Vec3::UnitZ(), 1);
  const auto uniform = [](F16 u1, F16 u2) {
    return Drawn{splat(-1), around_axis(splat3(Vec3(Vec3::UnitX())), 1.0f - 2.0f * u1, u2)};
  };
  const auto density = [](const V3x16&) { return splat(0.25f / kPiF); };
  const auto tilted = [](const V3x16& w) { return (1.0f + 0.06f * w.y) * (0.25f / kPiF); };
  EXPECT_GT(test_sampler(grid, uniform, density, 1).p_value, 1e-3);
  EXPECT_LT(test_sampler(grid, uniform, tilted, 1).p_value, 1e-6);
}

TEST(LobeSampler, LambertFollowsItsDensity) {
  test_lobe(LambertLobe{}, 0.5, SphereGrid(Outgoing(0.5).n, 1), 11);
}

class PhongSampler : public ::testing::TestWithParam<std::tuple<float, double>> {};

TEST_P(PhongSampler, FollowsItsDensity) {
  const auto [exponent, cosine] = GetParam();
  const Outgoing s(cosine);
  test_lobe(PhongLobe{Rgb::Ones(), exponent}, cosine, SphereGrid(scalar::mirror(s.n, s.wo), 4), 12);
}

INSTANTIATE_TEST_SUITE_P(Lobes, PhongSampler,
                         ::testing::Combine(::testing::Values(1.0f, 5.0f, 100.0f, 1000.0f),
                                            ::testing::Values(1.0, 0.5, 0.05)));

class GgxSampler : public ::testing::TestWithParam<std::tuple<float, double>> {};

TEST_P(GgxSampler, FollowsItsDensity) {
  const auto [alpha, cosine] = GetParam();
  const Outgoing s(cosine);
  test_lobe(GgxLobe{Rgb::Ones(), alpha}, cosine, SphereGrid(scalar::mirror(s.n, s.wo), 4), 13);
}

INSTANTIATE_TEST_SUITE_P(Lobes, GgxSampler,
                         ::testing::Combine(::testing::Values(0.5f, 0.14f, 0.03f),
                                            ::testing::Values(1.0, 0.7, 0.3, 0.1, 0.02)));

TEST(BsdfSampler, MixtureFollowsItsDensity) {
  Material matte{"matte", {LambertLobe{Rgb::Constant(0.4f)}}};
  Material mixed{"mixed",
                 {LambertLobe{Rgb(0.5f, 0.2f, 0.1f)}, PhongLobe{Rgb::Constant(0.3f), 50.0f},
                  GgxLobe{Rgb(0.2f, 0.4f, 0.1f), 0.15f}}};
  const std::vector<Bsdf> bsdfs = {Bsdf(matte), Bsdf(mixed)};
  for (const double cosine : {0.9, 0.2}) {
    const Outgoing s(cosine);
    const V3x16 n = splat3(s.n), wo = splat3(s.wo);
    for (std::int32_t id = 0; id < 2; ++id) {
      // Only the even lanes have the material, the odd ones the other.
      const I16 even = (lane_index() & 1) == 0;
      const I16 material = select(even, splat(id), splat(1 - id));
      const auto sampler = [&](F16 u1, F16 u2) {
        const V3x16 first = sample_bsdf(bsdfs, splat(-1), material, n, wo, u1, u2);
        const V3x16 second = sample_bsdf(bsdfs, splat(-1), 1 - material, n, wo, u1, u2);
        return Drawn{splat(-1), select(even, first, second)};
      };
      const auto density = [&](const V3x16& wi) {
        return evaluate_bsdf(bsdfs, splat(-1), splat(id), directions(n, wo, wi)).pdf;
      };
      expect_fits(test_sampler(SphereGrid(scalar::mirror(s.n, s.wo), 3), sampler, density, 14));
    }
  }
}

EmissiveTriangle emissive(const Vec3f& a, const Vec3f& b, const Vec3f& c, float radiance) {
  EmissiveTriangle t;
  t.p0 = a;
  t.e1 = b - a;
  t.e2 = c - a;
  const Vec3f cross = t.e1.cross(t.e2);
  t.area = 0.5f * cross.norm();
  t.normal = cross.normalized();
  t.radiance = Rgb::Constant(radiance);
  return t;
}

/// Distances along rays from the origin to a triangle's front, or a negative number.
F16 distance_to_front(const EmissiveTriangle& t, const V3x16& w) {
  F16 result = splat(-1.0f);
  for (int i = 0; i < kLanes; ++i) {
    Mat3 m;
    m << t.e1.cast<double>(), t.e2.cast<double>(), -lane(w, i);
    const Vec3 uvt = m.inverse() * -t.p0.cast<double>();
    const bool inside = uvt.x() >= 0.0 && uvt.y() >= 0.0 && uvt.x() + uvt.y() <= 1.0 && uvt.z() > 0.0;
    if (inside && t.normal.cast<double>().dot(lane(w, i)) < 0.0) result[i] = static_cast<float>(uvt.z());
  }
  return result;
}

void test_lights(const Lights& lights, const Vec3& n, const SphereGrid& grid, std::uint64_t seed) {
  const auto sampler = [&](F16 u1, F16 u2) {
    const LightSample16 s = lights.sample(V3x16{}, splat3(n), u1, u2);
    return Drawn{s.valid, s.direction};
  };
  const auto density = [&](const V3x16& w) {
    F16 sum = lights.environment().maxCoeff() > 0.0f ? lights.pdf_of_environment(dot(w, splat3(n))) : F16{};
    for (std::size_t i = 0; i < lights.triangles().size(); ++i) {
      const F16 distance = distance_to_front(lights.triangles()[i], w);
      const I16 met = distance > 0.0f;
      const F16 part = lights.pdf_of_hit(met, splat(static_cast<std::int32_t>(i)), w, distance);
      sum += select(met, part, F16{});
    }
    return sum;
  };
  expect_fits(test_sampler(grid, sampler, density, seed, 64));
}

const EmissiveTriangle kFrontal = emissive({-1, -1, 2}, {0, 1, 2}, {1, -1, 2.5f}, 1.0f);
const EmissiveTriangle kSlanted = emissive({1.5f, 0, 0.5f}, {2.5f, -1, 1.5f}, {3, 2, 2}, 3.0f);

TEST(LightSampler, TrianglesFollowTheirDensity) {
  for (const EmissiveTriangle& t : {kFrontal, kSlanted}) {
    const Vec3 center = (t.p0 + (t.e1 + t.e2) / 3.0f).cast<double>();
    ASSERT_LT(center.dot(t.normal.cast<double>()), 0.0) << "faces the origin";
    test_lights(Lights({t}, {}, Rgb::Zero(), 3.0), Vec3::UnitZ(), SphereGrid(center, 2), 15);
  }
}

TEST(LightSampler, SeveralTrianglesFollowTheirDensity) {
  EmissiveTriangle turned = kFrontal;  // shows its back
  turned.normal = -turned.normal;
  turned.p0.x() -= 3.0f;
  const Lights lights({kFrontal, kSlanted, turned}, {}, Rgb::Zero(), 3.0);
  test_lights(lights, Vec3::UnitZ(), SphereGrid(Vec3(0.5, 0, 1), 2), 16);
}

TEST(LightSampler, ManyTrianglesFollowTheirDensity) {
  std::vector<EmissiveTriangle> strip;  // more than the few lights that are searched linearly
  for (int i = 0; i < 20; ++i) {
    const float x = 0.2f * static_cast<float>(i) - 2.0f;
    strip.push_back(
        emissive({x, -0.5f, 1}, {x, 0.5f, 1}, {x + 0.2f, 0, 1}, 1.0f + static_cast<float>(i % 3)));
  }
  test_lights(Lights(strip, {}, Rgb::Zero(), 3.0), Vec3::UnitZ(), SphereGrid(Vec3::UnitZ(), 1, 24, 24), 17);
}

TEST(LightSampler, EnvironmentAndTrianglesFollowTheirDensity) {
  const Vec3 n = Vec3(0.2, 0.1, 1).normalized();
  test_lights(Lights({}, {}, Rgb::Ones(), 1.0), n, SphereGrid(n, 1), 18);
  test_lights(Lights({kFrontal}, {}, Rgb::Ones(), 0.5), n, SphereGrid(Vec3(0, 0, 1), 2), 19);
}

TEST(Bsdf, WeightsSharpnessByTheLobesShares) {
  const auto material = [](std::vector<Lobe> lobes) { return Bsdf(Material{"m", std::move(lobes), true}); };
  const LambertLobe diffuse{Rgb::Constant(0.6f)};
  const PhongLobe wide{Rgb::Constant(0.2f), 50.0f};
  const GgxLobe narrow{Rgb::Constant(0.2f), 0.05f};  // as a Phong lobe of exponent 200
  EXPECT_EQ(material({diffuse}).weighted_sharpness(), 0.0f);
  EXPECT_NEAR(material({wide}).weighted_sharpness(), 50.0f, 1e-4f);
  EXPECT_NEAR(material({diffuse, wide}).weighted_sharpness(), 12.5f, 1e-3f);
  EXPECT_NEAR(material({diffuse, wide, narrow}).weighted_sharpness(), 40.0f, 1e-2f);
  EXPECT_NEAR(material({diffuse, wide, narrow}).sharpness(), 200.0f, 1e-2f);
}

}  // namespace
}  // namespace vrc
