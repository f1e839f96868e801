// SPDX-License-Identifier: GPL-3.0-or-later
// The motion of silhouettes in the derivatives of gathered radiance, against finite differences.
#include <gtest/gtest.h>

#include "core/hash.h"
#include "derivatives_support.h"
#include "placement/guide.h"

namespace vrc {
namespace {

constexpr int kLog2Rays = 15;
constexpr double kStep = 0.006;  // of the scene's radius: a tenth of the distance to the boxes

test::Estimator estimator(const Scene& scene, bool occlusion_aware) {
  return [&scene, occlusion_aware](const RecordSite& site, std::uint64_t seed) {
    RayCounts counts;
    GatherOptions options;
    options.log2_rays = kLog2Rays;
    options.seed = seed;
    options.occlusion_aware = occlusion_aware;
    return gather_radiance(scene, site, options, counts).luminance;
  };
}

/// On the floor beside the short box, at .05 to .1 from it.
const std::vector<Vec2> kBesideTheBox = {{0.700, 0.977}, {0.673, 0.980}, {0.831, 0.947}, {0.651, 0.971}};

void expect_silhouettes_to_matter(const std::string& scene_name,
                                  const std::map<std::string, std::string>& defines) {
  const Scene scene = test::load_scene(scene_name, 256, 256, defines);
  const std::vector<RecordSite> sites = test::sites_at(scene, kBesideTheBox);
  for (const RecordSite& site : sites) ASSERT_NEAR(site.point.position.y(), 0.0, 1e-6);
  const std::vector<Jet2> truth = test::reference_derivatives(scene, sites, kStep);
  const test::RelativeError with = test::relative_error(estimator(scene, true), sites, truth);
  EXPECT_LT(with.gradient, 0.12);
  EXPECT_LT(with.hessian, 0.4);
  const test::RelativeError without = test::relative_error(estimator(scene, false), sites, truth);
  EXPECT_GT(without.gradient, 0.5);
  EXPECT_GT(without.hessian, 0.8);
  EXPECT_EQ(with.value, without.value);
  test::record_error("with", with);
  test::record_error("without", without);
}

TEST(Silhouettes, MoveBesideAnOccluderOfADiffuseFloor) {
  expect_silhouettes_to_matter("cornell_glossy.xml", {{"specular", "0"}});
}

TEST(Silhouettes, MoveBesideAnOccluderOfAPhongFloor) {
  expect_silhouettes_to_matter("cornell_glossy.xml", {{"exponent", "20"}});
}

TEST(Silhouettes, MoveBesideAnOccluderOfAGgxFloor) {
  expect_silhouettes_to_matter("cornell_ggx.xml", {{"wall_alpha", "0.3"}, {"box_alpha", "0.3"}});
}

/// The point where a ray touches a sphere or a pillar slides over it.
TEST(Silhouettes, SlideOverCurvedOccluders) {
  const Scene scene = test::load_scene("curved_room.xml", 256, 256, {{"specular", "0"}});
  const std::vector<RecordSite> sites = test::sites_at(scene, {{0.248, 0.834},
                                                               {0.5527, 0.8809},
                                                               {0.7637, 0.8809},
                                                               {0.6465, 0.9277},
                                                               {0.7637, 0.9277},
                                                               {0.4121, 0.9746}});
  for (const RecordSite& site : sites) ASSERT_NEAR(site.point.position.y(), 0.0, 1e-6);
  const std::vector<Jet2> truth = test::reference_derivatives(scene, sites, kStep);
  const test::RelativeError error = test::relative_error(estimator(scene, true), sites, truth);
  EXPECT_LT(error.gradient, 0.08);
  EXPECT_LT(error.hessian, 0.5);
  test::record_error("curved", error);
}

/// A guide moves the rows of the rays' grid apart, each column's in its own way; silhouettes are found all
/// the same.
TEST(Silhouettes, MoveInGuidedGathers) {
  const std::map<std::string, std::string> phong = {{"exponent", "20"}};
  const Scene scene = test::load_scene("cornell_glossy.xml", 256, 256, phong);
  const std::vector<RecordSite> sites = test::sites_at(scene, kBesideTheBox);
  const std::vector<Jet2> truth = test::reference_derivatives(scene, sites, kStep);
  const GuideField nothing(scene);
  const test::Estimator guided = [&](const RecordSite& site, std::uint64_t seed) {
    RayCounts counts;
    GatherOptions options;
    options.seed = hash(seed, 1u);
    GuideHistogram found;
    (void)gather_radiance(scene, site, options, counts, {nullptr, &found});
    const KeptHistogram own(found);
    const auto warp = nothing.warp_at(site, &own);
    options.seed = seed;
    return gather_radiance(scene, site, options, counts, {warp.get(), nullptr}).luminance;
  };
  const test::RelativeError error = test::relative_error(guided, sites, truth);
  EXPECT_LT(error.gradient, 0.15);
  EXPECT_LT(error.hessian, 0.5);
  test::record_error("guided", error);
}

TEST(Silhouettes, ChangeNothingInTheOpen) {
  const Scene scene = test::load_scene("half_box.xml", 256, 256);
  for (const RecordSite& site : test::sites_at(scene, {{0.9375, 0.5}, {0.1875, 0.4375}, {0.7, 0.5}})) {
    const Jet2 with = estimator(scene, true)(site, 1), without = estimator(scene, false)(site, 1);
    EXPECT_EQ(with.value, without.value);
    EXPECT_LT((with.gradient - without.gradient).norm(), 1e-3 * without.gradient.norm());
    EXPECT_LT((with.hessian - without.hessian).norm(), 1e-3 * without.hessian.norm());
  }
}

/// The claimed deviation of the derivatives is that of independent gathers, within a factor.
TEST(Silhouettes, AreCountedInTheVariance) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 256, 256);
  for (const RecordSite& site : test::sites_at(scene, kBesideTheBox)) {
    constexpr int kRuns = 64;
    double sum[2] = {}, squares[2] = {}, claimed[2] = {};
    for (int run = 0; run < kRuns; ++run) {
      RayCounts counts;
      GatherOptions options;
      options.seed = static_cast<std::uint64_t>(run + 1);
      const RadianceEstimate e = gather_radiance(scene, site, options, counts);
      for (int k = 0; k < 2; ++k) {
        const double g = e.luminance.gradient[k];
        sum[k] += g;
        squares[k] += g * g;
        claimed[k] += e.variance.gradient[k] / kRuns;
      }
    }
    for (int k = 0; k < 2; ++k) {
      const double variance = (squares[k] - sum[k] * sum[k] / kRuns) / (kRuns - 1.0);
      EXPECT_GT(claimed[k], variance / 3.0) << "direction " << k << " of " << site.key;
      EXPECT_LT(claimed[k], variance * 30.0) << "direction " << k << " of " << site.key;
    }
  }
}

}  // namespace
}  // namespace vrc
