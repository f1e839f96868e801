// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/guide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "placement_support.h"

namespace vrc {
namespace {

using namespace test;

constexpr int kCells = GuideHistogram::kCells;

GuideHistogram one_bright_cell(int cell) {
  GuideHistogram histogram;
  histogram.mean_square[static_cast<std::size_t>(cell)] = 1.0f;
  return histogram;
}

TEST(GuideWarp, WithoutFindingsMovesNothing) {
  const GuideWarp warp(GuideHistogram{}, {0});
  F16 v1{}, v2{};
  for (int i = 0; i < kLanes; ++i) {
    v1[i] = (static_cast<float>(i) + 0.3f) / kLanes;
    v2[i] = std::fmod(0.7f * static_cast<float>(i) + 0.1f, 1.0f);
  }
  const GuideWarp::Point16 p = warp(v1, v2);
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_NEAR(p.u1[i], v1[i], 1e-5f);
    EXPECT_NEAR(p.u2[i], v2[i], 1e-5f);
    EXPECT_NEAR(p.density[i], 1.0f, 1e-5f);
  }
}

/// Uniform points must fall into every cell as often as its density says.
TEST(GuideWarp, PointsHaveTheDensityThatItStates) {
  const GuideWarp warp(one_bright_cell(20 * GuideHistogram::kRows + 5), {0});
  constexpr int kPackets = 1 << 16;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<double> counts(kCells);
  for (int packet = 0; packet < kPackets; ++packet) {
    F16 v1{}, v2{};
    for (int i = 0; i < kLanes; ++i) {
      v1[i] = uniform(random);
      v2[i] = uniform(random);
    }
    const GuideWarp::Point16 p = warp(v1, v2);
    const I16 cells = guide_cells(p.u1, p.u2);
    for (int i = 0; i < kLanes; ++i) {
      ASSERT_FLOAT_EQ(p.density[i], warp.density(cells[i])) << "cell " << cells[i];
      counts[static_cast<std::size_t>(cells[i])] += 1.0;
    }
  }
  for (int cell = 0; cell < kCells; ++cell) {
    const double expected = static_cast<double>(warp.density(cell)) * kPackets * kLanes / kCells;
    EXPECT_NEAR(counts[static_cast<std::size_t>(cell)], expected, 5.0 * std::sqrt(expected))
        << "cell " << cell;
  }
}

TEST(GuideWarp, SmoothsWithinAStrategyOnlyAndRoundTheAzimuth) {
  constexpr int kRows = GuideHistogram::kRows;
  const GuideWarp warp(one_bright_cell(16 * kRows), {0, 16});
  const float elsewhere = warp.density(40 * kRows + kRows / 2);
  // In the other strategy nothing was found.
  EXPECT_FLOAT_EQ(warp.density(15 * kRows), warp.density(3 * kRows + kRows / 2));
  EXPECT_GT(warp.density(17 * kRows), 2.0f * elsewhere);
  EXPECT_GT(warp.density(16 * kRows + kRows - 1), 2.0f * elsewhere);
}

/// Whatever a guide says, the estimate stays what it was, and a guide by other rays makes it less noisy.
TEST(GuidedGather, StaysUnbiasedAndBecomesLessNoisy) {
  const Scene scene = load_scene("cornell_glossy.xml", 256, 256);
  const std::vector<RecordSite> sites = sites_at(scene, {{0.2, 0.5}, {0.5, 0.3}, {0.5, 0.9}, {0.8, 0.4}});
  GatherOptions options;
  options.log2_rays = 12;
  RayCounts counts;
  double plain_variance = 0.0, guided_variance = 0.0;
  for (const RecordSite& site : sites) {
    GuideHistogram found;
    options.seed = 1;
    (void)gather_radiance(scene, site, options, counts, {nullptr, &found});
    const GuideField nothing(scene);
    const KeptHistogram kept(found), misleading(one_bright_cell(0));
    const auto guided = nothing.warp_at(site, &kept), misled = nothing.warp_at(site, &misleading);
    double sum[3] = {}, squares[3] = {};
    constexpr int kSeeds = 32;
    for (int i = 0; i < kSeeds; ++i) {
      options.seed = static_cast<std::uint64_t>(i + 2);
      const GuideWarp* warps[3] = {nullptr, guided.get(), misled.get()};
      for (int g = 0; g < 3; ++g) {
        const double value =
            gather_radiance(scene, site, options, counts, {warps[g], nullptr}).luminance.value;
        sum[g] += value / kSeeds;
        squares[g] += value * value / kSeeds;
      }
    }
    const auto variance = [&](int g) { return std::max(squares[g] - sum[g] * sum[g], 0.0); };
    for (int g = 1; g < 3; ++g) {
      const double deviation = std::sqrt((variance(0) + variance(g)) / (kSeeds - 1));
      EXPECT_NEAR(sum[g], sum[0], 4.0 * deviation + 1e-6 * sum[0]) << "guide " << g;
    }
    plain_variance += variance(0) / (sum[0] * sum[0]);
    guided_variance += variance(1) / (sum[0] * sum[0]);
  }
  EXPECT_LT(guided_variance, plain_variance / 4.0);
}

TEST(KeptHistogram, RoundsToEightBits) {
  GuideHistogram histogram;
  for (std::size_t i = 0; i < histogram.mean_square.size(); ++i)
    histogram.mean_square[i] = i % 3 == 0 ? 0.0f : std::exp(0.01f * static_cast<float>(i) - 9.0f);
  const KeptHistogram kept(histogram);
  std::vector<float> cells(histogram.mean_square.size() - 5, 1.0f);
  kept.add_to(cells, 5, 0.5f);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const float expected = histogram.mean_square[i + 5];
    EXPECT_NEAR(cells[i], 1.0f + 0.5f * expected, 0x1p-9f * expected + 1e-6f);
  }
}

/// What a site's rays find by a wide gather.
std::shared_ptr<const KeptHistogram> found_at(const Scene& scene, const RecordSite& site) {
  GatherOptions options;
  options.log2_rays = 16;
  options.seed = 77;
  RayCounts counts;
  GuideHistogram found;
  (void)gather_radiance(scene, site, options, counts, {nullptr, &found});
  return std::make_shared<const KeptHistogram>(found);
}

/// Relative variance of gathers of 1024 rays.
double relative_variance(const Scene& scene, const RecordSite& site, const GuideWarp* warp) {
  constexpr int kSeeds = 64;
  GatherOptions options;
  options.log2_rays = 10;
  RayCounts counts;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kSeeds; ++i) {
    options.seed = static_cast<std::uint64_t>(i + 1000);
    const double value = gather_radiance(scene, site, options, counts, {warp, nullptr}).luminance.value;
    sum += value / kSeeds;
    squares += value * value / kSeeds;
  }
  return squares / (sum * sum) - 1.0;
}

/// Turned by `angle` about its tangent, the normal staying the camera's side.
RecordSite turned(RecordSite site, double angle) {
  site.point.normal = std::cos(angle) * site.frame.normal + std::sin(angle) * site.frame.bitangent;
  site.frame = Frame::around(site.point.normal);
  return site;
}

TEST(GuideField, KnowsNothingWithoutGathersNearby) {
  const Scene scene = load_scene("cornell_glossy.xml", 256, 256);
  const std::vector<RecordSite> sites = sites_at(scene, {{0.5, 0.3}});
  GuideField field(scene);
  EXPECT_EQ(field.warp_at(sites[0]), nullptr);
  field.add(sites[0], found_at(scene, sites[0]));
  EXPECT_NE(field.warp_at(sites[0]), nullptr);
  RecordSite far = sites[0];
  far.point.position += 30.0 * far.pixel_length * far.frame.tangent;
  EXPECT_EQ(field.warp_at(far), nullptr);
}

/// A gather on another slope of a curved surface looked in the same directions, in other cells of its square.
TEST(GuideField, CarriesDirectionsFromOneNormalToAnother) {
  for (const char* file : {"cornell_glossy.xml", "cornell_ggx.xml"}) {
    const Scene scene = load_scene(file, 256, 256);
    for (const RecordSite& site : sites_at(scene, {{0.2, 0.5}, {0.5, 0.3}, {0.8, 0.4}})) {
      const RecordSite other = turned(site, 0.1);
      GuideField field(scene);
      field.add(other, found_at(scene, other));
      const double plain = relative_variance(scene, site, nullptr);
      const double guided = relative_variance(scene, site, field.warp_at(site).get());
      EXPECT_LT(guided, plain / 3.0) << file;
      // The same cells of the site's own square would mislead: the light is elsewhere there.
      const double mistaken =
          relative_variance(scene, site, GuideField(scene).warp_at(site, found_at(scene, other).get()).get());
      EXPECT_LT(guided, mistaken) << file;
    }
  }
}

/// What lights a direction is known from another material, too.
TEST(GuideField, CarriesRadianceToOtherMaterials) {
  const Scene scene = load_scene("cornell_glossy.xml", 256, 256);
  const std::vector<RecordSite> sites = sites_at(scene, {{0.2, 0.5}});
  RecordSite other = sites[0];
  other.point.material = other.point.material == 0 ? 1 : 0;
  GuideField field(scene);
  field.add(other, found_at(scene, other));
  EXPECT_LT(relative_variance(scene, sites[0], field.warp_at(sites[0]).get()),
            relative_variance(scene, sites[0], nullptr) / 3.0);
}

}  // namespace
}  // namespace vrc
