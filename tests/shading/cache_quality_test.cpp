// SPDX-License-Identifier: GPL-3.0-or-later
// The picture by the cache against path tracing.
#include <gtest/gtest.h>

#include "geometry/polygon_soup.h"
#include "render_support.h"

namespace vrc {
namespace {

constexpr int kFewRecords = 100;  // So few that the interpolation shows.

RenderOptions indirect_by_cache(int records = 0, std::uint64_t seed = 1) {
  RenderOptions options = test::options_of(Method::kCache, 16, seed, Component::kIndirect);
  options.cache.records = records;
  return options;
}

struct Quality {
  const char* scene;
  int size;
  double most_relmse;
};

TEST(Cache, AgreesWithPathTracing) {
  for (const Quality& q : {Quality{"half_box.xml", 64, 2e-3}, Quality{"cornell_glossy.xml", 64, 7e-3},
                           Quality{"cornell_ggx.xml", 64, 8e-3}}) {
    const Scene scene = test::load_scene(q.scene, q.size, q.size);
    const test::IndirectReference reference(scene, 512);
    const Image image = render(scene, indirect_by_cache()).image;
    EXPECT_LT(reference.relmse(image), q.most_relmse) << q.scene;
    EXPECT_NEAR(reference.mean_ratio(image), 1.0, 0.015) << q.scene;
    Image brighter = image;
    for (float& v : brighter.pixels) v *= 1.1f;
    EXPECT_GT(reference.relmse(brighter), q.most_relmse) << "a tenth more light would not be noticed";
  }
}

TEST(Cache, AgreesWithPathTracingBeyondOneBounce) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 48, 48);
  RenderOptions options = indirect_by_cache();
  options.bounces = 3;
  RenderOptions path = test::options_of(Method::kPath, 512, 5, Component::kIndirect);
  path.bounces = 3;
  const Image by_path = render(scene, path).image;
  EXPECT_NEAR(compare_rgb(render(scene, options).image, by_path).mean_ratio, 1.0, 0.02);
  path.bounces = 1;
  EXPECT_LT(compare_rgb(render(scene, path).image, by_path).mean_ratio, 0.9);
}

TEST(Cache, InterpolatesBetterWithEachTaylorOrder) {
  const Scene scene = test::load_scene("glossy_pair.xml", 128, 128);
  const test::IndirectReference reference(scene, 512);
  std::array<double, 3> error{};
  for (int order = 0; order <= 2; ++order) {
    // Fewer, and regions outgrow the highlight: no polynomial fits it there.
    RenderOptions options = indirect_by_cache(3 * kFewRecords);
    options.cache.taylor_order = order;
    options.cache.hard_pixels = false;
    error[static_cast<std::size_t>(order)] = reference.relmse(render(scene, options).image);
  }
  EXPECT_LT(error[2], 0.7 * error[1]);
  EXPECT_LT(error[1], 0.7 * error[0]);
}

TEST(Cache, NeedsTheGlossyGlossyTermBetweenGlossySurfaces) {
  const Scene scene = test::load_scene("glossy_pair.xml", 128, 128);
  const test::IndirectReference reference(scene, 512);
  RenderOptions options = indirect_by_cache(2 * kFewRecords);
  const double with = reference.relmse(render(scene, options).image);
  options.cache.glossy_glossy = false;
  const double without = reference.relmse(render(scene, options).image);
  EXPECT_GT(without, 3.0 * with);
}

TEST(Cache, NeedsNoGlossyGlossyTermBelowADiffuseWall) {
  const Scene scene = test::load_scene("glossy_pair_diffuse.xml", 64, 64);
  RenderOptions options = indirect_by_cache(200);
  const Image with = render(scene, options).image;
  options.cache.glossy_glossy = false;
  EXPECT_EQ(with.pixels, render(scene, options).image.pixels);
}

/// The same scene in another unit of length.
SceneDescription scaled(SceneDescription scene, double factor) {
  Mat4 to_world = Mat4::Identity();
  to_world.topLeftCorner<3, 3>() *= factor;
  for (ShapeDescription& shape : scene.shapes) transform(shape.soup, to_world);
  scene.camera.origin *= factor;
  return scene;
}

TEST(Cache, DoesNotDependOnTheUnitOfLength) {
  for (const char* name : {"half_box.xml", "cornell_glossy.xml"}) {
    const SceneDescription description = test::describe_scene(name, 64, 64);
    const Scene metres(description), millimetres(scaled(description, 1000.0));
    // Roundings differ, and a point that is covered by a hair or not moves all records after it: single
    // numbers of records scatter.
    double records = 0.0, scaled_records = 0.0;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      RenderOptions options = indirect_by_cache(0, seed);
      options.cache.error_of_picture = false;  // trials of pictures of a few pixels scatter more
      const RenderResult a = render(metres, options), b = render(millimetres, options);
      EXPECT_LT(compare_rgb(b.image, a.image).relmse, 1e-3) << name << ", seed " << seed;
      records += static_cast<double>(a.stats.records);
      scaled_records += static_cast<double>(b.stats.records);
    }
    EXPECT_NEAR(scaled_records / records, 1.0, 0.01) << name;
  }
}

}  // namespace
}  // namespace vrc
