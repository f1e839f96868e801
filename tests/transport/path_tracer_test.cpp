// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes whose radiance is known in closed form, and estimators that have to agree.
#include "transport/path_tracer.h"

#include <gtest/gtest.h>

#include "core/hash.h"
#include "scalar_lobes.h"
#include "statistics.h"
#include "test_scenes.h"

namespace vrc {
namespace {

constexpr auto kIncoherent = RayTracer::Coherence::kIncoherent;

struct Traced {
  Estimate direct, indirect;
  RayCounts counts;
};

/// Means over packets of paths; a packet's sixteen samples stratify each other, so its mean is one draw.
Traced trace(const Scene& scene, const Vec3& origin, const Vec3& target, const PathOptions& options,
             int packets) {
  Traced result;
  const Vec3 direction = (target - origin).normalized();
  const SurfacePoint16 first = scene.intersect(splat(-1), ray16(origin, direction), kIncoherent);
  for (int packet = 0; packet < packets; ++packet) {
    const PathSampler16 sampler = {std::bit_cast<U16>(lane_index()),
                                   splat(static_cast<std::uint32_t>(hash(1234, packet)))};
    const PathRadiance16 radiance =
        trace_paths(scene, first, splat3(direction), splat(-1), sampler, options, result.counts);
    result.direct.add(lane_sum(radiance.direct.y) / kLanes);
    result.indirect.add(lane_sum(radiance.indirect.y) / kLanes);
  }
  return result;
}

void expect_mean(const Estimate& estimate, double expected, const char* what) {
  EXPECT_NEAR(estimate.mean(), expected, 4.0 * estimate.error() + 2e-4 * expected + 1e-6) << what;
  EXPECT_LT(estimate.error(), 0.02 * expected + 1e-6) << what << ": the test is too noisy to say anything";
}

// Closed rooms that emit and reflect the same everywhere.

constexpr float kEmission = 0.8f;

Scene furnace(PolygonSoup room, float reflectance) {
  SceneDescription description;
  add_shape(description, inside_out(std::move(room)), matte(reflectance), kEmission);
  return Scene(description);
}

/// Sum of rho^k, k = first .. last.
double geometric_sum(double rho, int first, int last) {
  double sum = 0.0;
  for (int k = first; k <= last; ++k) sum += std::pow(rho, k);
  return sum;
}

class Furnace : public ::testing::TestWithParam<int> {};

TEST_P(Furnace, RadianceIsTheGeometricSeries) {
  const int bounces = GetParam();
  const PathOptions options = {.bounces = bounces};
  struct Room {
    Scene scene;
    double rho;
  };
  const Room rooms[] = {{furnace(make_cube(), 0.5f), 0.5},
                        {furnace(make_cube(), 0.8f), 0.8},
                        {furnace(make_sphere(Vec3(5, 1, -2), 1.5, 6), 0.7f), 0.7}};
  for (const Room& room : rooms) {
    const Vec3 center = room.rho == 0.7 ? Vec3(5, 1, -2) : Vec3(0, 0, 0);
    const Traced traced = trace(room.scene, center, center + Vec3(0.3, 0.9, 0.2), options, 600);
    expect_mean(traced.direct, kEmission * (1.0 + room.rho), "direct");
    const int last = bounces < 0 ? 200 : bounces + 1;
    expect_mean(traced.indirect, kEmission * geometric_sum(room.rho, 2, last), "indirect");
  }
}

INSTANTIATE_TEST_SUITE_P(Bounces, Furnace, ::testing::Values(0, 1, 2, 6, -1));

TEST(FurnaceParts, AreSeparate) {
  const Scene room = furnace(make_cube(), 0.5f);
  const Vec3 target(0.3, 0.9, 0.2);
  const Traced no_direct = trace(room, Vec3::Zero(), target, {.bounces = 2, .direct = false}, 400);
  EXPECT_EQ(no_direct.direct.mean(), 0.0);
  expect_mean(no_direct.indirect, kEmission * geometric_sum(0.5, 2, 3), "indirect alone");
  const Traced no_indirect = trace(room, Vec3::Zero(), target, {.bounces = 2, .indirect = false}, 400);
  EXPECT_EQ(no_indirect.indirect.mean(), 0.0);
  expect_mean(no_indirect.direct, kEmission * 1.5, "direct alone");
}

TEST(ReflectedRadiance, LeavesOutTheEmissionOfTheFirstPoint) {
  const Scene room = furnace(make_cube(), 0.5f);
  const Vec3 direction = Vec3(0.3, 0.9, 0.2).normalized();
  const SurfacePoint16 first = room.intersect(splat(-1), ray16(Vec3::Zero(), direction), kIncoherent);
  for (const int bounces : {0, 1, 3}) {
    Estimate estimate;
    RayCounts counts;
    for (int packet = 0; packet < 400; ++packet) {
      const PathSampler16 sampler = {std::bit_cast<U16>(lane_index()),
                                     splat(static_cast<std::uint32_t>(hash(5, packet)))};
      estimate.add(
          lane_sum(
              reflected_radiance(room, first, splat3(direction), splat(-1), sampler, bounces, counts).x) /
          kLanes);
    }
    expect_mean(estimate, kEmission * geometric_sum(0.5, 1, bounces + 1), "reflected");
  }
}

// Convex objects under a constant sky see nothing but the sky.

struct OpenCase {
  Lobe lobe;
  double cosine;
};

class OpenFurnace : public ::testing::TestWithParam<OpenCase> {};

TEST_P(OpenFurnace, ReflectsItsDirectionalAlbedo) {
  const auto& [lobe, cosine] = GetParam();
  SceneDescription description;
  description.environment = Rgb::Constant(0.6f);
  add_shape(description, make_cube(), Material{"lobe", {lobe}});
  const Scene scene(description);
  const Vec3 n = Vec3::UnitZ(), wo(std::sqrt(1.0 - cosine * cosine), 0.0, cosine), target(0.2, -0.3, 1.0);
  const double albedo = SphereGrid(scalar::mirror(n, wo), 4, 64, 64).integral([&](const V3x16& wi) {
    F16 value;
    for (int i = 0; i < kLanes; ++i) {
      const Vec3 w = lane(wi, i).normalized();
      value[i] =
          static_cast<float>(std::visit([&](const auto& l) { return scalar::shape(l, n, wo, w); }, lobe));
    }
    return value;
  });
  const Traced traced = trace(scene, target + 3.0 * wo, target, {.bounces = 2}, 600);
  expect_mean(traced.direct, 0.6 * albedo, "direct");
  EXPECT_EQ(traced.indirect.mean(), 0.0) << "nothing else is there to reflect";
}

INSTANTIATE_TEST_SUITE_P(Lobes, OpenFurnace,
                         ::testing::Values(OpenCase{LambertLobe{Rgb::Ones()}, 0.5},
                                           OpenCase{PhongLobe{Rgb::Ones(), 5.0f}, 0.9},
                                           OpenCase{PhongLobe{Rgb::Ones(), 100.0f}, 0.2},
                                           OpenCase{GgxLobe{Rgb::Ones(), 0.5f}, 0.7},
                                           OpenCase{GgxLobe{Rgb::Ones(), 0.14f}, 0.2},
                                           OpenCase{GgxLobe{Rgb::Ones(), 0.03f}, 0.5}));

TEST(PathTracer, SkyIsSeenWhereNothingIsHit) {
  SceneDescription description;
  description.environment = Rgb::Constant(0.6f);
  add_shape(description, make_cube(), matte(0.5f));
  const Traced traced = trace(Scene(description), Vec3(0, 0, 3), Vec3(0, 5, 3), {}, 4);
  EXPECT_NEAR(traced.direct.mean(), 0.6, 1e-6);
  EXPECT_EQ(traced.counts.other + traced.counts.shadow, 0u);
}

// A rectangular light above a floor.

/// Form factor from a point to a parallel rectangle [0, a] x [0, b] at height h above it.
double corner_form_factor(double a, double b, double h) {
  const double x = a / h, y = b / h, rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.0 * kPi);
}

/// To [x0, x1] x [y0, y1] relative to the point, by adding and subtracting corners.
double form_factor(double x0, double x1, double y0, double y1, double h) {
  const auto corner = [h](double x, double y) {
    return std::copysign(1.0, x) * std::copysign(1.0, y) * corner_form_factor(std::abs(x), std::abs(y), h);
  };
  return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

SceneDescription lit_floor(double height, const Material& floor) {
  SceneDescription description;
  add_shape(description, placed(make_rectangle(), Vec3(5, 5, 1), Vec3::Zero()), floor);
  PolygonSoup light = inside_out(placed(make_rectangle(), Vec3(0.6, 0.4, 1), Vec3(0.3, 0.1, height)));
  add_shape(description, std::move(light), Material{}, 10.0f);
  return description;
}

TEST(PathTracer, RectangleLightIsItsFormFactor) {
  // Down to heights far below the size of the scene, where lifted shadow rays come close to the light.
  for (const double height : {2.0, 0.5, 0.1, 0.02}) {
    const Scene scene(lit_floor(height, matte(0.5f)));
    for (const Vec3& target : {Vec3(0.1, 0.05, 0), Vec3(0.9, 0.5, 0), Vec3(1.5, -0.7, 0)}) {
      const double factor =
          form_factor(-0.3 - target.x(), 0.9 - target.x(), -0.3 - target.y(), 0.5 - target.y(), height);
      // From the side, under the light.
      const Vec3 viewer = target + 0.01 * height * Vec3(0.3, -1.0, 0.5);
      const Traced traced = trace(scene, viewer, target, {.bounces = 0}, 1500);
      EXPECT_NEAR(traced.direct.mean(), 0.5 * 10.0 * factor,
                  4.0 * traced.direct.error() + 1e-3 * 5.0 * factor)
          << "height " << height << " at " << target.transpose();
    }
  }
}

/// Direct light at a point by light sampling alone, by BSDF sampling alone and combined.
struct ThreeWays {
  Estimate lights, bsdf, combined;
};

ThreeWays three_ways(const Scene& scene, const Vec3& viewer, const Vec3& target, int packets) {
  ThreeWays result;
  Random random(77);
  const Vec3 direction = (target - viewer).normalized();
  const SurfacePoint16 p = scene.intersect(splat(-1), ray16(viewer, direction), kIncoherent);
  const V3x16 wo = -splat3(direction);
  const auto value = [&](const V3x16& wi) {
    return evaluate_bsdf(scene.bsdfs(), splat(-1), p.material, directions(p.normal, wo, wi));
  };
  for (int packet = 0; packet < packets; ++packet) {
    const F16 u1 = random.uniform16(), u2 = random.uniform16(), u3 = random.uniform16(),
              u4 = random.uniform16();
    const LightSample16 light = scene.lights().sample(p.position, p.normal, u1, u2);
    const I16 blocked = scene.tracer().occluded(
        splat(-1), {scene.lifted(p), light.direction, light.distance * 0.999f}, kIncoherent);
    const F16 by_light = light.radiance.y * value(light.direction).f_cos.y;
    const V3x16 wi = sample_bsdf(scene.bsdfs(), splat(-1), p.material, p.normal, wo, u3, u4);
    const BsdfValue16 sampled = value(wi);
    const SurfacePoint16 met = scene.intersect(splat(-1), {scene.lifted(p), wi, splat(1e17f)}, kIncoherent);
    const I16 on_light = met.hit & (met.light >= 0);
    const F16 emission = scene.lights().emitted(on_light, met.light, wi).y;
    for (int i = 0; i < kLanes; ++i) {
      result.lights.add(light.valid[i] != 0 && blocked[i] == 0 ? by_light[i] : 0.0);
      result.bsdf.add(on_light[i] != 0 && sampled.pdf[i] > 0.0f
                          ? emission[i] * sampled.f_cos.y[i] / sampled.pdf[i]
                          : 0.0);
    }
  }
  result.combined = trace(scene, viewer, target, {.bounces = 0}, packets / 4).direct;
  return result;
}

TEST(PathTracer, LightSamplingBsdfSamplingAndTheirCombinationAgree) {
  const Material materials[] = {
      matte(0.5f),
      {"phong", {LambertLobe{Rgb::Constant(0.3f)}, PhongLobe{Rgb::Constant(0.4f), 40.0f}}},
      {"ggx", {GgxLobe{Rgb::Ones(), 0.2f}}}};
  for (const Material& material : materials) {
    SceneDescription description = lit_floor(1.0, material);
    // Half of the light is hidden behind a black screen.
    add_shape(description, placed(make_cube(), Vec3(0.2, 0.6, 0.01), Vec3(0.3, 0, 0.5)), Material{});
    const Scene scene(description);
    const ThreeWays ways = three_ways(scene, Vec3(-0.7, 0.2, 0.6), Vec3(0, 0, 0), 6000);
    EXPECT_GT(ways.combined.mean(), 0.01) << material.name;
    EXPECT_LT(std::abs(z_score(ways.lights, ways.bsdf)), 4.0) << material.name;
    EXPECT_LT(std::abs(z_score(ways.lights, ways.combined)), 4.0)
        << material.name << ": " << ways.lights.mean() << " against " << ways.combined.mean();
    EXPECT_LT(std::abs(z_score(ways.bsdf, ways.combined)), 4.0) << material.name;
    EXPECT_LT(ways.combined.error(), 0.01 * ways.combined.mean()) << material.name;
  }
}

TEST(PathTracer, PointAndDirectionalLightsAreExact) {
  SceneDescription description;
  add_shape(description, placed(make_rectangle(), Vec3(5, 5, 1), Vec3::Zero()), matte(0.5f));
  description.delta_lights = {PointLight{Vec3(0, 3, 4), Rgb::Constant(20.0f)}};
  EXPECT_NEAR(trace(Scene(description), Vec3(1, 1, 1), Vec3::Zero(), {.bounces = 0}, 4).direct.mean(),
              0.5 / kPi * 20.0 * 0.8 / 25.0, 1e-5);
  description.delta_lights = {DirectionalLight{Vec3(0, -0.6, -0.8), Rgb::Constant(3.0f)}};
  EXPECT_NEAR(trace(Scene(description), Vec3(1, 1, 1), Vec3::Zero(), {.bounces = 0}, 4).direct.mean(),
              0.5 / kPi * 3.0 * 0.8, 1e-5);
  // A black ball in between.
  add_shape(description, make_sphere(Vec3(0, 1.5, 2), 0.3, 6), Material{});
  EXPECT_EQ(trace(Scene(description), Vec3(1, 1, 1), Vec3::Zero(), {.bounces = 0}, 4).direct.mean(), 0.0);
}

TEST(PathTracer, TinyFarLightsStayFinite) {
  // Densities per solid angle whose squares do not fit into single precision.
  SceneDescription description;
  add_shape(description, placed(make_rectangle(), Vec3(1e4, 1e4, 1), Vec3::Zero()), matte(0.5f));
  add_shape(description, inside_out(placed(make_rectangle(), Vec3(1e-7, 1e-7, 1), Vec3(0, 0, 1000.0))),
            Material{}, 1e20f);
  const Traced traced = trace(Scene(description), Vec3(0, 10, 900), Vec3(3000, 0, 0), {.bounces = 0}, 4);
  const double cosine = 1.0 / std::sqrt(10.0), distance2 = 1e6 + 9e6;
  const double expected = 0.5 / kPi * 1e20 * 4e-14 * cosine * cosine / distance2;
  EXPECT_NEAR(traced.direct.mean(), expected, 1e-3 * expected);
}

TEST(PathTracer, InactiveLanesAndBlackSurfacesAddNothing) {
  const Scene room = furnace(make_cube(), 0.5f);
  const V3x16 direction = splat3(Vec3(Vec3::UnitX()));
  const SurfacePoint16 first = room.intersect(splat(-1), ray16(Vec3::Zero(), Vec3::UnitX()), kIncoherent);
  const I16 active = lane_index() < 5;
  RayCounts counts;
  const PathRadiance16 radiance = trace_paths(
      room, first, direction, active, {std::bit_cast<U16>(lane_index()), U16{}}, {.bounces = 2}, counts);
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_EQ(radiance.direct.x[i] > 0.0f, i < 5);
    EXPECT_EQ(radiance.indirect.x[i] > 0.0f, i < 5);
  }
  EXPECT_LE(counts.shadow, 15u);
  EXPECT_LE(counts.other, 15u);
  EXPECT_GT(counts.shadow, 0u);
  EXPECT_EQ(counts.camera + counts.gather, 0u) << "these are the caller's";
}

TEST(PathTracer, SameSamplersGiveTheSameBytes) {
  const Scene room = furnace(make_cube(), 0.5f);
  const auto once = [&] {
    return trace(room, Vec3::Zero(), Vec3(0.3, 0.9, 0.2), {.bounces = -1}, 20).indirect.mean();
  };
  EXPECT_EQ(once(), once());
}

}  // namespace
}  // namespace vrc
