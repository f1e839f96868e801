// SPDX-License-Identifier: GPL-3.0-or-later
// Caches whose records hold spherical harmonics, and the earlier methods, against path tracing.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/parallel.h"
#include "placement/baselines.h"
#include "render_support.h"

namespace vrc {
namespace {

constexpr int kSize = 64;

RenderOptions indirect_by(Representation representation, int records = 0) {
  RenderOptions options = test::options_of(Method::kCache, 16, 1, Component::kIndirect);
  options.cache.representation = representation;
  options.cache.records = records;
  options.cache.gather_rays = 4096;
  return options;
}

std::size_t count_harmonics(const RenderResult& result) {
  return static_cast<std::size_t>(
      std::ranges::count_if(result.cache->records(), [](const auto& r) { return r.uses_harmonics(); }));
}

TEST(HarmonicsCache, AgreesWithPathTracingWhereLobesAreWide) {
  const Scene scene = test::load_scene("half_box.xml", kSize, kSize, {{"exponent", "8"}});
  const test::IndirectReference reference(scene, 512);
  RenderOptions options = indirect_by(Representation::kHarmonics);
  options.cache.harmonics_order = 10;
  const Image image = render(scene, options).image;
  EXPECT_LT(reference.relmse(image), 2e-3);
  EXPECT_NEAR(reference.mean_ratio(image), 1.0, 0.015);
}

TEST(HarmonicsCache, OfLowOrderRingsWhereLobesAreSharp) {
  // [Zhao Fig. 2]: the same number of records, exponent 100.
  const Scene scene = test::load_scene("half_box.xml", kSize, kSize);
  const test::IndirectReference reference(scene, 512);
  RenderOptions options = indirect_by(Representation::kHarmonics, 400);
  options.cache.harmonics_order = 10;
  const double harmonics = reference.relmse(render(scene, options).image);
  const double analytic = reference.relmse(render(scene, indirect_by(Representation::kAnalytic, 400)).image);
  EXPECT_GT(harmonics, 10.0 * analytic);
}

TEST(HarmonicsCache, ServesOtherCamerasWithTheRecordsThereAre) {
  Scene scene = test::load_scene("half_box.xml", kSize, kSize, {{"exponent", "8"}});
  RenderOptions options = indirect_by(Representation::kHarmonics);
  options.cache.strategy = Strategy::kViewIndependent;
  options.cache.error = 0.1;
  options.cache.harmonics_order = 10;
  const RenderResult first = render(scene, options);
  EXPECT_EQ(first.stats.records_made, first.stats.records);

  Camera moved = scene.camera();
  moved.origin += 0.05 * moved.right;
  scene.look_through(moved);
  const RenderResult second = render(scene, options, {}, {&*first.cache, first.scale});
  EXPECT_EQ(second.stats.records, first.stats.records + second.stats.records_made);
  EXPECT_LT(4 * second.stats.records_made, first.stats.records);
  for (std::size_t i = 0; i < first.stats.records; ++i) {
    EXPECT_EQ(second.cache->records()[i].harmonics, first.cache->records()[i].harmonics);
  }
  const test::IndirectReference reference(scene, 512);
  EXPECT_LT(reference.relmse(second.image), 5e-3);
  EXPECT_NEAR(reference.mean_ratio(second.image), 1.0, 0.02);
}

TEST(HybridCache, HoldsHarmonicsOnCurvedSurfacesOnly) {
  const Scene scene = test::load_scene("curved_room.xml", kSize, kSize, {{"exponent", "20"}});
  RenderOptions options = indirect_by(Representation::kHybrid);
  options.cache.harmonics_rule = HarmonicsRule::kPaper;
  const RenderResult result = render(scene, options);
  const std::size_t harmonics = count_harmonics(result);
  EXPECT_GT(harmonics, 20u);
  EXPECT_LT(harmonics, result.stats.records / 2);
  for (const RadianceRecord& r : result.cache->records()) {
    EXPECT_EQ(r.uses_harmonics(), r.curvature.needs_sh());
    EXPECT_EQ(r.harmonics != nullptr, r.uses_harmonics()) << "harmonics are gathered where they are used";
    if (r.uses_harmonics()) {
      EXPECT_EQ(r.harmonics_reason, HarmonicsReason::kTurns);
      EXPECT_GT(r.site.point.shape_operator.norm(), 0.0);
    }
  }
}

TEST(HybridCache, AgreesWithPathTracingByEitherRule) {
  for (const char* name : {"curved_room.xml", "object_sphere.xml", "object_torus.xml", "pots.xml"}) {
    const Scene scene = test::load_scene(name, kSize, kSize, {{"exponent", "20"}});
    const test::IndirectReference reference(scene, 512);
    const double analytic = reference.relmse(render(scene, indirect_by(Representation::kAnalytic)).image);
    for (const HarmonicsRule rule : {HarmonicsRule::kPaper, HarmonicsRule::kAuto}) {
      RenderOptions options = indirect_by(Representation::kHybrid);
      options.cache.harmonics_rule = rule;
      const Image image = render(scene, options).image;
      EXPECT_LT(reference.relmse(image), 1.5 * analytic + 1e-3) << name << static_cast<int>(rule);
      EXPECT_NEAR(reference.mean_ratio(image), 1.0, 0.02) << name << static_cast<int>(rule);
    }
  }
}

TEST(HybridCache, IsTheAnalyticCacheOnFlatSurfaces) {
  const Scene scene = test::load_scene("cornell_glossy.xml", kSize, kSize);
  const RenderResult hybrid = render(scene, indirect_by(Representation::kHybrid));
  EXPECT_EQ(count_harmonics(hybrid), 0u);
  EXPECT_EQ(hybrid.image.pixels, render(scene, indirect_by(Representation::kAnalytic)).image.pixels);
}

TEST(HarmonicsCache, IsTheSameAtAnyNumberOfThreads) {
  const Scene scene = test::load_scene("curved_room.xml", 32, 32, {{"exponent", "20"}});
  for (const Representation r : {Representation::kHarmonics, Representation::kHybrid}) {
    for (const Strategy strategy : {Strategy::kViewDependent, Strategy::kViewIndependentOutgoing}) {
      RenderOptions options = indirect_by(r);
      options.cache.strategy = strategy;
      options.cache.harmonics_rule = HarmonicsRule::kPaper;
      options.cache.gather_rays = 1024;
      set_thread_count(1);
      const Image one = render(scene, options).image;
      set_thread_count(2);
      EXPECT_EQ(one.pixels, render(scene, options).image.pixels);
      set_thread_count(0);
    }
  }
}

TEST(Baselines, AgreeWithPathTracingInADiffuseRoom) {
  const Scene scene = test::load_scene("cornell_glossy.xml", kSize, kSize, {{"specular", "0"}});
  const test::IndirectReference reference(scene, 512);
  for (const Baseline baseline : {Baseline::kKrivanek, Baseline::kWard, Baseline::kSchwarzhaupt}) {
    RenderOptions options = indirect_by(Representation::kAnalytic);
    options.cache.harmonics_order = 4;
    options.cache = baseline_options(baseline, options.cache);
    const RenderResult result = render(scene, options);
    EXPECT_EQ(count_harmonics(result), result.stats.records);
    EXPECT_LT(reference.relmse(result.image), 1e-2) << static_cast<int>(baseline);
    EXPECT_NEAR(reference.mean_ratio(result.image), 1.0, 0.02) << static_cast<int>(baseline);
  }
}

TEST(Baselines, OfIrradianceRefuseGlossySurfaces) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 16, 16);
  RenderOptions options = indirect_by(Representation::kAnalytic);
  options.cache = baseline_options(Baseline::kWard, options.cache);
  EXPECT_THROW(static_cast<void>(render(scene, options)), InputError);
}

}  // namespace
}  // namespace vrc
