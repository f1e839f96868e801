// SPDX-License-Identifier: GPL-3.0-or-later
// What records are placed for, so that the picture has the accepted error.
#include "../../shading/src/error_goal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "render_support.h"

namespace vrc {
namespace {

constexpr double kAccepted = 0.05;

/// A placement of a small picture, tried by what a function says.
struct Fixture : ErrorTrial {
  Scene scene = test::load_scene("half_box.xml", 48, 48);
  FilmSampler film{scene.camera(), scene.film(), 4, 1};
  RunControl control;
  RecordPlacer placer{scene, {0, 0, 48, 48, &film}, {}, 1, 1, control};
  std::function<double(double)> expected;
  std::vector<double> tried;

  double relative_error(double error) override {
    EXPECT_EQ(placer.open_share(), 0.0);
    tried.push_back(error);
    return expected(error);
  }
  double cover(std::function<double(double)> expect) {
    expected = std::move(expect);
    return cover_within_error(placer, kAccepted, control, *this);
  }
};

TEST(ErrorGoal, IsReachedByTheFirstRecordsWhereThePictureIsGoodEnough) {
  Fixture f;
  const double error = f.cover([](double e) { return 0.5 * e; });
  EXPECT_GT(error, 1.5 * kAccepted);
  EXPECT_EQ(f.tried, std::vector<double>{error});
  EXPECT_EQ(f.placer.snapshot().scale.error, error);
}

TEST(ErrorGoal, IsReachedByMoreRecordsWhereThePictureIsWorse) {
  for (const double factor : {1.0, 2.5}) {
    Fixture f;
    const double error = f.cover([&](double e) { return factor * e; });
    EXPECT_NEAR(factor * error, kAccepted, 0.15 * kAccepted);
    EXPECT_EQ(f.placer.snapshot().scale.error, error);
    EXPECT_EQ(f.placer.open_share(), 0.0);
  }
}

TEST(ErrorGoal, IsGivenUpWhereRecordsDoNotHelp) {
  Fixture f;
  const double error = f.cover([](double) { return 3.0 * kAccepted; });
  EXPECT_GT(error, 0.01 * kAccepted);
  EXPECT_LE(f.tried.size(), 4u);
}

TEST(ErrorGoal, HoldsInThePicture) {
  for (const char* name : {"cornell_glossy.xml", "cornell_ggx.xml", "curved_room.xml", "object_torus.xml"}) {
    const Scene scene = test::load_scene(name, 112, 112);
    const test::IndirectReference reference(scene, 128, 512);
    RenderOptions options = test::options_of(Method::kCache, 16, 1, Component::kIndirect);
    double last = 0.0;
    for (const double error : {0.08, 0.03}) {
      options.cache.error = error;
      const RenderResult result = render(scene, options);
      const double measured = std::sqrt(reference.relmse(result.image));
      EXPECT_LT(measured, 2.0 * error) << name;
      EXPECT_GT(measured, 0.5 * error) << name;
      EXPECT_EQ(result.stats.error, error);
      EXPECT_EQ(result.stats.records_error, result.scale.error);
      EXPECT_GT(result.stats.records, last);
      last = static_cast<double>(result.stats.records);
    }
  }
}

TEST(ErrorGoal, IsOfRecordsWhereThatIsAskedFor) {
  const Scene scene = test::load_scene("half_box.xml", 64, 64);
  RenderOptions options = test::options_of(Method::kCache, 4, 1, Component::kIndirect);
  const RenderResult of_picture = render(scene, options);
  options.cache.error_of_picture = false;
  const RenderResult of_records = render(scene, options);
  EXPECT_EQ(of_records.stats.records_error, options.cache.error);
  EXPECT_GT(of_records.stats.records, of_picture.stats.records);
  // Nothing tells what shading will find while records are made.
  options.cache.error_of_picture = true;
  options.cache.overture = options.cache.joint_fit = options.cache.hard_pixels = false;
  EXPECT_EQ(render(scene, options).stats.records_error, options.cache.error);
}

}  // namespace
}  // namespace vrc
