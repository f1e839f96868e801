// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/gather.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "placement_support.h"
#include "transport/path_tracer.h"

namespace vrc {
namespace {

/// Running mean and variance.
struct Moments {
  double count = 0.0, sum = 0.0, squares = 0.0;

  void add(double v) {
    count += 1.0;
    sum += v;
    squares += v * v;
  }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double variance() const { return (squares - sum * sum / count) / (count - 1.0); }
};

const std::vector<Vec2> kCornellSites = {{0.5, 0.85}, {0.12, 0.5}, {0.45, 0.3}, {0.68, 0.72}};

/// The silhouettes' part of derivatives is found on the grid of the rays, so that its mean depends on their
/// number: without it the means must agree, with it the variance must still be claimed.
void expect_small_gathers_to_agree(bool occlusion_aware) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 128, 128);
  constexpr int kRuns = 256;
  for (const RecordSite& site : test::sites_at(scene, kCornellSites)) {
    const auto gather = [&](int log2_rays, std::uint64_t seed) {
      RayCounts counts;
      GatherOptions options;
      options.log2_rays = log2_rays;
      options.seed = seed;
      options.occlusion_aware = occlusion_aware;
      return gather_radiance(scene, site, options, counts);
    };
    std::vector<Moments> found(6), claimed(6);
    for (int run = 0; run < kRuns; ++run) {
      const RadianceEstimate e = gather(10, static_cast<std::uint64_t>(run + 1));
      const auto jet = test::entries(e.luminance), variance = test::entries(e.variance);
      for (std::size_t i = 0; i < 6; ++i) {
        found[i].add(jet[i]);
        claimed[i].add(variance[i]);
      }
    }
    const RadianceEstimate large = gather(18, 12345);
    const auto expected = test::entries(large.luminance), expected_variance = test::entries(large.variance);
    for (std::size_t i = 0; i < 6; ++i) {
      // Twenty-four comparisons: 4.5 sigma is passed by chance once in 6000 runs.
      const double sigma = std::sqrt(found[i].variance() / kRuns + expected_variance[i]);
      if (i == 0 || !occlusion_aware) {
        EXPECT_LT(std::abs(found[i].mean() - expected[i]) / sigma, 4.5)
            << "entry " << i << " of " << site.key;
      }
      // The batches know nothing of the stratification between them, so that the claim is too high
      // where the integrand is smooth: derivatives may be overestimated, but never underestimated.
      const double ratio = claimed[i].mean() / found[i].variance();
      EXPECT_GT(ratio, 1.0 / 3.0) << "entry " << i << " of " << site.key;
      EXPECT_LT(ratio, i == 0 ? 3.0 : 30.0) << "entry " << i << " of " << site.key;
    }
  }
}

TEST(Gather, ManySmallGathersAgreeWithALargeOneAndWithTheirVariance) { expect_small_gathers_to_agree(false); }

TEST(Gather, SmallGathersClaimTheVarianceOfSilhouettes) { expect_small_gathers_to_agree(true); }

/// Mean of path samples at the site, an estimate that shares only the scene with the gather's.
Moments path_luminance(const Scene& scene, const RecordSite& site, int bounces) {
  const Vec3 direction = -site.to_camera.normalized();
  I16 all = splat(-1);
  const Ray16 ray = {splat3(scene.camera().origin), splat3(direction), splat(1e17f)};
  const SurfacePoint16 first = scene.intersect(all, ray, RayTracer::Coherence::kIncoherent);
  Moments result;
  RayCounts counts;
  for (std::uint32_t packet = 0; packet < 4096; ++packet) {
    // Each packet has a seed of its own, so that packets are independent.
    const PathSampler16 sampler = {std::bit_cast<U16>(lane_index()), splat(packet * 7919u + 5u)};
    const PathRadiance16 radiance =
        trace_paths(scene, first, splat3(direction), all, sampler, {bounces, true, false}, counts);
    result.add(static_cast<double>(lane_sum(luminance(radiance.indirect))) / kLanes);
  }
  return result;
}

TEST(Gather, AgreesWithPathTracing) {
  for (const char* name : {"cornell_glossy.xml", "cornell_ggx.xml"}) {
    const Scene scene = test::load_scene(name, 128, 128);
    for (const RecordSite& site : test::sites_at(scene, kCornellSites)) {
      for (const int bounces : {1, 3}) {
        const Moments path = path_luminance(scene, site, bounces);
        const RadianceEstimate e = test::gather(scene, site, 15, 3, true, bounces);
        const double sigma = std::sqrt(path.variance() / path.count + e.variance.value);
        EXPECT_LT(std::abs(path.mean() - e.luminance.value) / sigma, 4.5) << name << ", site " << site.key;
        // The comparison must be able to fail.
        EXPECT_LT(sigma, 0.1 * e.luminance.value) << name << ", site " << site.key << ", " << bounces;
      }
    }
  }
}

TEST(Gather, ChoosingPointsOfTheLightLowersTheNoiseAndLeavesTheMean) {
  constexpr int kRuns = 96;
  for (const char* name : {"half_box.xml", "cornell_ggx.xml"}) {
    const Scene scene = test::load_scene(name, 128, 128);
    double chosen_noise = 0.0, noise = 0.0;
    for (const RecordSite& site : test::sites_at(scene, kCornellSites)) {
      const auto value_and_gradient = [&](bool choose_light) {
        std::vector<Moments> moments(3);
        for (int run = 0; run < kRuns; ++run) {
          RayCounts counts;
          GatherOptions options;
          options.log2_rays = 10;
          options.seed = static_cast<std::uint64_t>(2 * run + (choose_light ? 1 : 0));
          options.occlusion_aware = false;
          options.choose_light = choose_light;
          const auto jet = test::entries(gather_radiance(scene, site, options, counts).luminance);
          for (std::size_t i = 0; i < moments.size(); ++i) moments[i].add(jet[i]);
        }
        return moments;
      };
      const auto chosen = value_and_gradient(true), plain = value_and_gradient(false);
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        const double sigma = std::sqrt((chosen[i].variance() + plain[i].variance()) / kRuns);
        EXPECT_LT(std::abs(chosen[i].mean() - plain[i].mean()) / sigma, 4.5)
            << name << ", site " << site.key << ", entry " << i;
      }
      chosen_noise += chosen[0].variance() / (plain[0].mean() * plain[0].mean());
      noise += plain[0].variance() / (plain[0].mean() * plain[0].mean());
    }
    EXPECT_LT(chosen_noise, 0.4 * noise) << name;
  }
}

TEST(Gather, MoreBouncesBringMoreLight) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 128, 128);
  for (const RecordSite& site : test::sites_at(scene, kCornellSites)) {
    const double one = test::gather(scene, site, 14, 1, true, 1).luminance.value;
    const double two = test::gather(scene, site, 14, 1, true, 2).luminance.value;
    const double all = test::gather(scene, site, 14, 1, true, -1).luminance.value;
    EXPECT_GT(two, 1.05 * one);
    EXPECT_GT(all, 1.02 * two);
  }
}

TEST(Gather, HasNoGlossyGlossyTermBelowADiffuseWall) {
  const Scene scene = test::load_scene("glossy_pair_diffuse.xml", 128, 128);
  for (const RecordSite& site : test::sites_at(scene, {{0.5, 0.5}, {0.4, 0.6}})) {
    EXPECT_EQ(test::entries(test::gather(scene, site, 12, 1, true).luminance),
              test::entries(test::gather(scene, site, 12, 1, false).luminance));
  }
}

ShapeDescription square(const std::string& id, double height, bool facing_up, std::uint32_t material,
                        const Rgb& emission) {
  ShapeDescription shape;
  shape.id = id;
  shape.soup.source = id;
  shape.soup.positions = {{-1, height, -1}, {-1, height, 1}, {1, height, 1}, {1, height, -1}};
  const std::vector<std::uint32_t> up = {0, 1, 2, 3}, down = {3, 2, 1, 0};
  shape.soup.add_face(facing_up ? up : down);
  shape.materials = {material};
  shape.emission = {emission};
  return shape;
}

/// A diffuse floor below a black lamp, under a sky.
SceneDescription floor_below_lamp() {
  SceneDescription d;
  d.source = "floor_below_lamp";
  Material diffuse;
  diffuse.lobes = {LambertLobe{}, PhongLobe{}};
  d.materials = {diffuse, Material{}};
  d.shapes = {square("floor", 0.0, true, 0, Rgb::Zero()), square("lamp", 1.0, false, 1, Rgb::Constant(3.0f))};
  d.environment = Rgb::Constant(0.5f);
  d.camera = look_at({0.3, 0.6, 0.2}, {0, 0, 0}, {1, 0, 0}, 30, 32, 32);
  return d;
}

TEST(Gather, SeesNoIndirectLightWhereItHitsOnlyEmittersAndSky) {
  const Scene scene(floor_below_lamp());
  for (const RecordSite& site : test::sites_at(scene, {{0.5, 0.5}, {0.2, 0.7}})) {
    const RadianceEstimate e = test::gather(scene, site, 10, 1);
    for (std::size_t i = 0; i < 6; ++i) {
      for (const Jet2& channel : e.radiance) EXPECT_EQ(test::entries(channel)[i], 0.0);
      EXPECT_EQ(test::entries(e.luminance)[i], 0.0);
      EXPECT_EQ(test::entries(e.variance)[i], 0.0);
    }
    EXPECT_NEAR(e.hits.nearest, 1.0, 0.02);
    EXPECT_NEAR(e.hits.nearest_direction.y(), 1.0, 0.02);
    EXPECT_GT(e.hits.mean_inverse, 0.0);
    EXPECT_LT(e.hits.mean_inverse, 1.0);
  }
}

TEST(Gather, FindsNothingUnderAnEmptySky) {
  SceneDescription d = floor_below_lamp();
  d.shapes.pop_back();
  const Scene scene(d);
  for (const RecordSite& site : test::sites_at(scene, {{0.5, 0.5}})) {
    const RadianceEstimate e = test::gather(scene, site, 10, 1);
    EXPECT_EQ(e.luminance.value, 0.0);
    EXPECT_TRUE(std::isinf(e.hits.nearest));
    EXPECT_EQ(e.hits.mean_inverse, 0.0);
  }
}

/// What gathers find of their surroundings that follow the bending surface, and that do not, over a lattice
/// of the sites that the camera sees and `wanted` takes.
template <typename Wanted>
std::vector<std::pair<HitDistances, HitDistances>> distances_of(const Scene& scene, const Wanted& wanted) {
  constexpr int kSide = 24;
  std::vector<std::pair<HitDistances, HitDistances>> result;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2 share(((i % kSide) + 0.5) / kSide, ((i / kSide) + 0.5) / kSide);
    const auto point = scene.seen_at(share[0] * scene.camera().width, share[1] * scene.camera().height);
    if (!point || !wanted(*point)) continue;
    const RecordSite site = make_site(scene, *point, static_cast<std::uint64_t>(i));
    RayCounts counts;
    GatherOptions flat;
    flat.total_derivative = false;
    result.emplace_back(gather_radiance(scene, site, {}, counts).hits,
                        gather_radiance(scene, site, flat, counts).hits);
  }
  return result;
}

TEST(Gather, TheHollowOfABowlIsNotNearToItself) {
  const Scene scene = test::load_scene("object_bowl.xml", 128, 128);
  const auto distances = distances_of(scene, [](const SurfacePoint& p) {
    return p.shape_operator.trace() < 0.0 && p.shape_operator.determinant() > 0.0;
  });
  ASSERT_GT(distances.size(), 30u);
  std::vector<double> ratios;
  for (const auto& [total, flat] : distances) {
    EXPECT_GE(total.nearest, flat.nearest);
    EXPECT_EQ(total.mean_inverse, flat.mean_inverse);
    ratios.push_back(total.nearest / flat.nearest);
  }
  std::ranges::nth_element(ratios, ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2));
  EXPECT_GT(ratios[ratios.size() / 2], 3.0);
}

TEST(Gather, ATorusIsNearToItselfAndSoAreWallsOfABox) {
  for (const char* name : {"object_torus.xml", "cornell_glossy.xml"}) {
    const auto distances =
        distances_of(test::load_scene(name, 128, 128), [](const SurfacePoint&) { return true; });
    ASSERT_GT(distances.size(), 300u);
    for (const auto& [total, flat] : distances) {
      EXPECT_EQ(total.nearest, flat.nearest) << name;
      EXPECT_EQ(total.nearest_direction, flat.nearest_direction) << name;
    }
  }
}

TEST(Gather, CountsItsRaysAndRepeatsItself) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 64, 64);
  const std::vector<RecordSite> sites = test::sites_at(scene, {{0.5, 0.85}});
  ASSERT_EQ(sites.size(), 1u);
  RayCounts counts;
  GatherOptions options;
  options.log2_rays = 11;
  const RadianceEstimate a = gather_radiance(scene, sites[0], options, counts);
  EXPECT_LE(counts.gather, 2048u);
  EXPECT_GT(counts.gather, 1024u);
  EXPECT_LE(counts.shadow, counts.gather);
  EXPECT_EQ(counts.other, 0u);
  const RadianceEstimate b = gather_radiance(scene, sites[0], options, counts);
  EXPECT_EQ(test::entries(a.luminance), test::entries(b.luminance));
  options.seed = 1;
  EXPECT_NE(gather_radiance(scene, sites[0], options, counts).luminance.value, a.luminance.value);
}

}  // namespace
}  // namespace vrc
