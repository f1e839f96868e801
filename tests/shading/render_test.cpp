// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/render.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>

#include "core/parallel.h"
#include "render_support.h"

namespace vrc {
namespace {

constexpr std::array<Method, 3> kMethods = {Method::kCache, Method::kPath, Method::kDirect};

bool same_bytes(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(float)) == 0;
}

bool all_finite(const Image& image) {
  return std::ranges::all_of(image.pixels, [](float v) { return std::isfinite(v); });
}

/// Mean of channels [first, first + 3).
double mean_of(const Image& image, std::size_t first) {
  double sum = 0.0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) sum += image.pixels[p * image.channels.size() + first + c];
  }
  return sum / (3.0 * static_cast<double>(image.pixel_count()));
}

TEST(Render, GivesTheSameBytesAtAnyThreadCount) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 48, 40);
  for (const Method method : kMethods) {
    RenderOptions options = test::options_of(method, 16);
    options.aovs = true;
    set_thread_count(1);
    const RenderResult one = render(scene, options);
    set_thread_count(2);
    const RenderResult two = render(scene, options);
    EXPECT_TRUE(same_bytes(one.image, two.image)) << static_cast<int>(method);
    EXPECT_EQ(one.stats.records, two.stats.records);
    EXPECT_EQ(one.stats.gather_rays, two.stats.gather_rays);
    options.seed = 2;
    EXPECT_FALSE(same_bytes(one.image, render(scene, options).image));
  }
}

TEST(Render, NamesItsLayersAndKeepsThemFinite) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 32, 32);
  for (const Method method : kMethods) {
    RenderOptions options = test::options_of(method, 4);
    const std::size_t of_error = method == Method::kCache ? 1 : 0;
    EXPECT_EQ(render(scene, options).image.channels.size(), 9u + of_error);
    options.aovs = true;
    const RenderResult result = render(scene, options);
    EXPECT_EQ(result.image.channels.size(), 16u + of_error);
    EXPECT_EQ(result.image.channels.back(), "depth.Z");
    EXPECT_TRUE(all_finite(result.image));
    EXPECT_EQ(result.cache.has_value(), method == Method::kCache);
    EXPECT_EQ(result.stats.records > 0, method == Method::kCache);
    EXPECT_GE(result.stats.camera_rays, 32u * 32u * 4u);
    EXPECT_FALSE(result.stats.unfinished);
  }
}

TEST(Render, AddsUpDirectAndIndirectLight) {
  const Scene scene = test::load_scene("half_box.xml", 32, 32);
  for (const Method method : kMethods) {
    const Image full = render(scene, test::options_of(method, 16)).image;
    const Image direct = render(scene, test::options_of(method, 16, 1, Component::kDirect)).image;
    const Image indirect = render(scene, test::options_of(method, 16, 1, Component::kIndirect)).image;
    for (std::size_t p = 0; p < full.pixel_count(); ++p) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t i = p * full.channels.size() + c;
        EXPECT_NEAR(full.pixels[i], direct.pixels[i] + indirect.pixels[i], 1e-5f * (1.0f + full.pixels[i]));
        EXPECT_EQ(full.pixels[i], full.pixels[i + 3] + full.pixels[i + 6]);
      }
    }
    EXPECT_EQ(mean_of(indirect, 0) > 0.0, method != Method::kDirect);
  }
}

TEST(Render, HasNoIndirectLightWithoutBounces) {
  const Scene scene = test::load_scene("half_box.xml", 32, 32);
  for (const Method method : kMethods) {
    RenderOptions options = test::options_of(method, 4);
    options.bounces = 0;
    const RenderResult result = render(scene, options);
    EXPECT_EQ(mean_of(result.image, 6), 0.0);
    EXPECT_GT(mean_of(result.image, 3), 0.0);
    EXPECT_EQ(mean_of(result.image, 0), mean_of(result.image, 3));
    EXPECT_EQ(result.stats.records, 0u);
  }
}

TEST(Render, CropsToTheSamePixels) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 48, 48);
  const CropWindow window = {7, 11, 38, 45};
  for (const Method method : {Method::kPath, Method::kDirect}) {
    RenderOptions options = test::options_of(method, 8);
    const Image full = render(scene, options).image;
    options.crop = window;
    const Image part = render(scene, options).image;
    EXPECT_TRUE(same_bytes(crop(full, 7, 11, 38, 45), crop(part, 7, 11, 38, 45)));
    double outside = 0.0;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) {
        if (x < 7 || x >= 38 || y < 11 || y >= 45)
          outside += static_cast<double>(std::abs(part.pixel(x, y)[0]));
      }
    }
    EXPECT_EQ(outside, 0.0);
  }
}

TEST(Render, KeepsTheMeanUnderAGaussianFilter) {
  SceneDescription description = test::describe_scene("cornell_glossy.xml", 64, 64);
  RenderOptions options = test::options_of(Method::kDirect, 64);
  const Image box = render(Scene(description), options).image;
  description.film.filter = PixelFilter::kGaussian;
  const Image gaussian = render(Scene(description), options).image;
  EXPECT_NEAR(mean_of(gaussian, 0) / mean_of(box, 0), 1.0, 0.01);
  EXPECT_FALSE(same_bytes(box, gaussian));
}

TEST(Render, SamplesMoreLightsOnRequest) {
  const Scene scene = test::load_scene("half_box.xml", 32, 32);
  RenderOptions options = test::options_of(Method::kDirect, 4);
  options.light_samples = 1;
  const RenderResult one = render(scene, options);
  options.light_samples = 16;
  const RenderResult many = render(scene, options);
  EXPECT_GT(many.stats.shadow_rays, 10 * one.stats.shadow_rays);
  EXPECT_NEAR(mean_of(many.image, 3) / mean_of(one.image, 3), 1.0, 0.05);
}

TEST(Render, StopsAtOnceWhenItIsAskedTo) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 32, 32);
  const std::atomic<bool> stop{true};
  RunControl control;
  control.stop = &stop;
  for (const Method method : kMethods) {
    const RenderResult result = render(scene, test::options_of(method, 16), control);
    EXPECT_TRUE(result.stats.unfinished);
    EXPECT_EQ(mean_of(result.image, 0), 0.0);
  }
}

TEST(Render, GivesWhatThereIsWhenStoppedHalfWay) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 64, 64);
  for (const Method method : kMethods) {
    std::atomic<bool> stop{false};
    RunControl control;
    control.stop = &stop;
    control.progress = [&](const ProgressUpdate& update) {
      if (update.phase == "render" && update.fraction > 0.3) stop = true;
    };
    const RenderOptions options = test::options_of(method, 16);
    const RenderResult part = render(scene, options, control);
    EXPECT_TRUE(part.stats.unfinished);
    EXPECT_TRUE(all_finite(part.image));
    const double share = mean_of(part.image, 0) / mean_of(render(scene, options).image, 0);
    EXPECT_GT(share, 0.02);
    EXPECT_LT(share, 0.95);
  }
}

TEST(Render, ReportsItsProgress) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 48, 48);
  std::map<std::string_view, int> updates;
  RunControl control;
  control.progress = [&](const ProgressUpdate& update) {
    EXPECT_GE(update.fraction, 0.0);
    EXPECT_LE(update.fraction, 1.0);
    ++updates[update.phase];
  };
  const RenderResult result = render(scene, test::options_of(Method::kCache, 4), control);
  for (const char* phase : {"place records", "render", "hard pixels"}) EXPECT_GT(updates[phase], 0) << phase;
  EXPECT_EQ(result.stats.phases.back().name, "hard pixels");
}

}  // namespace
}  // namespace vrc
