// SPDX-License-Identifier: GPL-3.0-or-later
// The path tracer against itself: runs of other seeds differ only by the noise that they show.
#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "render_support.h"

namespace vrc {
namespace {

constexpr int kRuns = 16;
constexpr int kBlock = 8;

/// Chance that Student's t with `freedom` degrees exceeds |t| on either side, by Simpson's rule over
/// the angle atan(t / sqrt(freedom)).
double two_sided_chance(double t, double freedom) {
  const double begin = std::atan(std::abs(t) / std::sqrt(freedom)), end = 0.5 * kPi;
  const auto density = [&](double angle) { return std::pow(std::max(std::cos(angle), 0.0), freedom - 1.0); };
  constexpr int kSteps = 400;
  const double h = (end - begin) / kSteps;
  double sum = density(begin) + density(end);
  for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * density(begin + i * h);
  const double norm = std::tgamma(0.5 * (freedom + 1.0)) / (std::sqrt(kPi) * std::tgamma(0.5 * freedom));
  return 2.0 * norm * sum * h / 3.0;
}

TEST(StudentT, HasTheTabulatedChances) {
  EXPECT_NEAR(two_sided_chance(0.0, 30), 1.0, 1e-6);
  EXPECT_NEAR(two_sided_chance(2.042, 30), 0.05, 1e-4);
  EXPECT_NEAR(two_sided_chance(3.646, 30), 0.001, 1e-5);
}

/// Means over blocks of pixels and their sums of squared deviations over runs.
struct BlockMoments {
  std::vector<double> sum, squares;

  BlockMoments(const Scene& scene, const RenderOptions& base, std::uint64_t first_seed) {
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      RenderOptions options = base;
      options.seed = first_seed + run;
      const Image blocks = block_means(render(scene, options).image, kBlock);
      sum.resize(blocks.pixels.size());
      squares.resize(blocks.pixels.size());
      for (std::size_t i = 0; i < blocks.pixels.size(); ++i) {
        const double v = blocks.pixels[i];
        sum[i] += v;
        squares[i] += v * v;
      }
    }
  }
  [[nodiscard]] double mean(std::size_t i) const { return sum[i] / kRuns; }
  [[nodiscard]] double variance(std::size_t i) const {
    return std::max(squares[i] - sum[i] * sum[i] / kRuns, 0.0) / (kRuns - 1.0);
  }
};

/// Smallest chance over the blocks, after Sidak's correction for their number.
double corrected_chance(const BlockMoments& a, const BlockMoments& b, double bias = 1.0) {
  double smallest = 1.0;
  int tests = 0;
  for (std::size_t i = 0; i < a.sum.size(); ++i) {
    const double variance = (a.variance(i) + b.variance(i)) / kRuns;
    if (variance < 1e-16) continue;  // Black, or a channel that does not depend on the seed.
    smallest = std::min(
        smallest, two_sided_chance((bias * a.mean(i) - b.mean(i)) / std::sqrt(variance), 2 * kRuns - 2));
    ++tests;
  }
  EXPECT_GT(tests, 300);
  return 1.0 - std::pow(1.0 - smallest, tests);
}

TEST(PathTracer, DiffersBetweenSeedsOnlyByNoise) {
  for (const char* name : {"cornell_glossy.xml", "half_box.xml"}) {
    const Scene scene = test::load_scene(name, 64, 64);
    // The picture's layers direct and indirect are tested together.
    const RenderOptions options = test::options_of(Method::kPath, 16);
    const BlockMoments a(scene, options, 100), b(scene, options, 200);
    EXPECT_GT(corrected_chance(a, b), 0.001) << name;
    EXPECT_LT(corrected_chance(a, b, 1.25), 0.001) << name << ": a quarter more light would not be noticed";
  }
}

TEST(PathTracer, GivesTheSameDirectLightAsTheDirectMethod) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 64, 64);
  RenderOptions path = test::options_of(Method::kPath, 16, 1, Component::kDirect);
  RenderOptions direct = test::options_of(Method::kDirect, 16, 1, Component::kDirect);
  const BlockMoments a(scene, path, 300), b(scene, direct, 400);
  EXPECT_GT(corrected_chance(a, b), 0.001);
}

double total_variance(const BlockMoments& moments) {
  double sum = 0.0;
  for (std::size_t i = 0; i < moments.sum.size(); ++i) sum += moments.variance(i);
  return sum;
}

TEST(GuidedPaths, DifferFromPathsByLessNoiseAndNothingElse) {
  for (const char* name : {"cornell_glossy.xml", "half_box.xml", "curved_room.xml"}) {
    const Scene scene = test::load_scene(name, 64, 64);
    const RenderOptions paths = test::options_of(Method::kPath, 256, 1, Component::kIndirect);
    RenderOptions guided = test::options_of(Method::kPath, 16, 1, Component::kIndirect);
    guided.path_rays = 256;
    const BlockMoments a(scene, paths, 500), b(scene, guided, 600);
    EXPECT_GT(corrected_chance(a, b), 0.001) << name;
    EXPECT_LT(corrected_chance(a, b, 1.1), 0.001) << name << ": a tenth more light would not be noticed";
    // From as many camera samples, so that edges are as noisy.
    const RenderOptions few_paths = test::options_of(Method::kPath, 16, 1, Component::kIndirect);
    EXPECT_LT(total_variance(b), 0.25 * total_variance(BlockMoments(scene, few_paths, 900))) << name;
  }
}

TEST(GuidedPaths, AreUnbiasedWhereSurfacesBendWithinAPixel) {
  // Normals turn by up to a tenth over a pixel: rays leave points of other normals than their directions are
  // for.
  const Scene scene = test::load_scene("object_torus.xml", 64, 64);
  const RenderOptions paths = test::options_of(Method::kPath, 256, 1, Component::kIndirect);
  RenderOptions guided = test::options_of(Method::kPath, 16, 1, Component::kIndirect);
  guided.path_rays = 128;
  const BlockMoments a(scene, paths, 500), b(scene, guided, 600);
  EXPECT_GT(corrected_chance(a, b), 0.001);
  EXPECT_LT(corrected_chance(a, b, 1.1), 0.001) << "a tenth more light would not be noticed";
  const RenderOptions few_paths = test::options_of(Method::kPath, 16, 1, Component::kIndirect);
  EXPECT_LT(total_variance(b), 0.25 * total_variance(BlockMoments(scene, few_paths, 900)));
}

TEST(GuidedPaths, BounceOnAsPathsDo) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 64, 64);
  RenderOptions paths = test::options_of(Method::kPath, 64, 1, Component::kIndirect);
  RenderOptions guided = test::options_of(Method::kPath, 16, 1, Component::kIndirect);
  guided.path_rays = 256;
  paths.bounces = guided.bounces = 3;
  const BlockMoments a(scene, paths, 700), b(scene, guided, 800);
  EXPECT_GT(corrected_chance(a, b), 0.001);
}

TEST(GuidedPaths, AreTheSameAtAnyNumberOfThreads) {
  const Scene scene = test::load_scene("cornell_glossy.xml", 32, 32);
  RenderOptions options = test::options_of(Method::kPath, 4);
  options.path_rays = 256;
  set_thread_count(1);
  const Image one = render(scene, options).image;
  set_thread_count(0);
  EXPECT_EQ(one.pixels, render(scene, options).image.pixels);
}

}  // namespace
}  // namespace vrc
