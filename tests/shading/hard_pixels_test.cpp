// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels that are gathered again, and the estimates of the error.
#include <gtest/gtest.h>

#include <cmath>

#include "render_support.h"

namespace vrc {
namespace {

constexpr int kSize = 192;

test::IndirectReference guided_reference(const Scene& scene) { return {scene, 128, 512}; }

RenderOptions indirect(double error) {
  RenderOptions options = test::options_of(Method::kCache, 16, 1, Component::kIndirect);
  options.cache.error = error;
  return options;
}

TEST(HardPixels, LowerTheErrorAtEdgesAndShadows) {
  const Scene scene = test::load_scene("cornell_glossy.xml", kSize, kSize);
  const test::IndirectReference reference = guided_reference(scene);
  RenderOptions options = indirect(0.02);
  options.cache.error_of_picture = false;  // the same records for all
  const RenderResult with = render(scene, options);
  options.cache.hard_pixels = false;
  const RenderResult edges_only = render(scene, options);
  options.cache.supersample_edges = false;
  const RenderResult without = render(scene, options);
  EXPECT_GT(with.stats.hard_pixels, 100u);
  EXPECT_LT(with.stats.hard_pixels, with.image.pixel_count() / 4);
  EXPECT_EQ(edges_only.stats.hard_pixels, 0u);
  EXPECT_LT(reference.relmse(with.image), 0.6 * reference.relmse(edges_only.image));
  EXPECT_LT(reference.relmse(edges_only.image), reference.relmse(without.image));
}

TEST(HardPixels, EstimateTheErrorOfThePicture) {
  for (const char* name : {"half_box.xml", "cornell_glossy.xml", "cornell_ggx.xml", "curved_room.xml"}) {
    const Scene scene = test::load_scene(name, 112, 112);
    const test::IndirectReference reference = guided_reference(scene);
    for (const double error : {0.1, 0.03}) {
      const RenderResult result = render(scene, indirect(error));
      const double measured = std::sqrt(reference.relmse(result.image));
      EXPECT_GT(result.stats.relative_error, 0.5 * measured) << name << ", error " << error;
      EXPECT_LT(result.stats.relative_error, 2.0 * measured) << name << ", error " << error;
      EXPECT_EQ(result.stats.error, error);
    }
  }
}

TEST(TimedRender, ShowsAllLightHoweverLittleTimeThereIs) {
  for (const char* name : {"half_box.xml", "curved_room.xml"}) {
    const Scene scene = test::load_scene(name, 112, 112);
    const test::IndirectReference reference = guided_reference(scene);
    const RenderResult careful = render(scene, indirect(0.03));
    RenderOptions options = indirect(0.03);
    options.seconds = 1e-3;
    // A single picture's light scatters with the records that the clock lets it have.
    constexpr int kPictures = 6;
    double mean_ratio = 0.0;
    for (options.seed = 1; options.seed <= kPictures; ++options.seed) {
      const RenderResult hasty = render(scene, options);
      EXPECT_LT(hasty.stats.records, careful.stats.records / 4);
      EXPECT_GT(hasty.stats.relative_error, 2.0 * careful.stats.relative_error) << name;
      mean_ratio += reference.mean_ratio(hasty.image) / kPictures;
    }
    EXPECT_NEAR(mean_ratio, 1.0, 0.03) << name;
  }
}

TEST(HardPixels, LeaveAnErrorOfNothingInTheDark) {
  SceneDescription description = test::describe_scene("half_box.xml", 32, 32);
  for (ShapeDescription& shape : description.shapes) shape.emission.clear();
  const RenderResult result = render(Scene(description), indirect(0.1));
  EXPECT_EQ(result.stats.relative_error, 0.0);
  for (const float v : result.image.pixels) EXPECT_EQ(v, 0.0f);
}

TEST(ErrorLayer, IsLargerWhereThePictureIsWorse) {
  const Scene scene = test::load_scene("cornell_glossy.xml", kSize, kSize);
  const test::IndirectReference reference = guided_reference(scene);
  std::vector<std::pair<double, double>> pixels;      // estimated and measured squared error
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {  // four leave the ratio between 3.7 and 4.9
    RenderOptions options = indirect(0.05);
    options.seed = seed;
    const Image image = render(scene, options).image;
    const auto channel = std::ranges::find(image.channels, "error.Y") - image.channels.begin();
    ASSERT_LT(channel, std::ssize(image.channels));
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const float* v = image.pixel(x, y);
        const auto off_by = [&](std::size_t half) {
          const float* r = reference.halves[half].pixel(x, y);
          return luminance(std::array{v[0], v[1], v[2]}) * reference.scale -
                 luminance(std::array{r[0], r[1], r[2]});
        };
        const double estimate = static_cast<double>(v[channel] * reference.scale);
        EXPECT_TRUE(std::isfinite(estimate) && estimate >= 0.0);
        pixels.emplace_back(estimate * estimate, static_cast<double>(off_by(0) * off_by(1)));
      }
    }
  }
  std::ranges::sort(pixels);
  const auto measured = [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += pixels[i].second;
    return sum / static_cast<double>(end - begin);
  };
  const std::size_t all = pixels.size();
  const double largest = measured(3 * all / 4, all), small = measured(all / 4, all / 2);
  RecordProperty("ratio", std::to_string(largest / small));
  EXPECT_GT(largest, 4.0 * small);
}

}  // namespace
}  // namespace vrc
