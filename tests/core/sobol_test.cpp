// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/sobol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "core/hash.h"

namespace vrc {
namespace {

using Point = std::array<std::uint32_t, kSobolDimensions>;  // 32-bit fractions
using Points = std::vector<Point>;

std::uint32_t seed_of(std::uint64_t number) { return static_cast<std::uint32_t>(hash(0x7e57u, number)); }

Points sobol_points(std::uint32_t begin, int log2_count) {
  Points points(std::size_t{1} << log2_count);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (int d = 0; d < kSobolDimensions; ++d) points[i][d] = sobol(begin + i, d);
  }
  return points;
}

std::uint32_t to_fraction(float u) { return static_cast<std::uint32_t>(static_cast<double>(u) * 0x1p32); }

/// How many points are in each elementary interval with `digits[d]` binary digits in dimension d.
std::map<std::uint64_t, int> box_counts(const Points& points,
                                        const std::array<int, kSobolDimensions>& digits) {
  std::map<std::uint64_t, int> counts;
  for (const Point& p : points) {
    std::uint64_t box = 0;
    for (int d = 0; d < kSobolDimensions; ++d) {
      box = (box << digits[d]) | (digits[d] == 0 ? 0u : p[d] >> (32 - digits[d]));
    }
    ++counts[box];
  }
  return counts;
}

/// Every elementary interval of the first two dimensions with the volume 2^-k has one of 2^k points.
bool is_net(const Points& points) {
  const int k = std::countr_zero(points.size());
  for (int a = 0; a <= k; ++a) {
    if (box_counts(points, {a, k - a, 0, 0}).size() != points.size()) return false;
  }
  return true;
}

/// Sizes of the boxes, sorted: what a nested scramble of each dimension cannot change.
std::vector<int> sorted_counts(const Points& points, const std::array<int, kSobolDimensions>& digits) {
  std::vector<int> sizes;
  for (const auto& [box, count] : box_counts(points, digits)) sizes.push_back(count);
  std::ranges::sort(sizes);
  return sizes;
}

TEST(Sobol, FirstPointsAreThePublishedOnes) {
  // [JoeKuo2008] list their points in the order of the Gray code.
  const double published[8][kSobolDimensions] = {{0, 0, 0, 0},
                                                 {.5, .5, .5, .5},
                                                 {.75, .25, .25, .25},
                                                 {.25, .75, .75, .75},
                                                 {.375, .375, .625, .875},
                                                 {.875, .875, .125, .375},
                                                 {.625, .125, .875, .625},
                                                 {.125, .625, .375, .125}};
  for (std::uint32_t i = 0; i < 8; ++i) {
    for (int d = 0; d < kSobolDimensions; ++d) {
      EXPECT_EQ(sobol(i ^ (i >> 1), d) * 0x1p-32, published[i][d]) << "point " << i << " dimension " << d;
    }
  }
}

TEST(Sobol, AlignedBlocksAreNetsInTheFirstTwoDimensions) {
  for (int k = 0; k <= 10; ++k) {
    for (const std::uint32_t block : {0u, 1u, 5u, 0x12345u})
      EXPECT_TRUE(is_net(sobol_points(block << k, k))) << k;
  }
}

TEST(Sobol, EveryDimensionIsStratified) {
  const Points points = sobol_points(0, 12);
  for (int d = 0; d < kSobolDimensions; ++d) {
    std::array<int, kSobolDimensions> digits{};
    digits[d] = 12;
    EXPECT_EQ(box_counts(points, digits).size(), points.size()) << d;
  }
}

TEST(OwenScramble, PermutesThePrefixesOfEveryLength) {
  for (std::uint64_t s = 0; s < 20; ++s) {
    const std::uint32_t seed = seed_of(s);
    for (const int digits : {1, 3, 8, 12}) {
      std::set<std::uint32_t> images;
      for (std::uint32_t prefix = 0; prefix < (1u << digits); ++prefix) {
        const std::uint32_t begin = prefix << (32 - digits), tail = (1u << (32 - digits)) - 1u;
        const std::uint32_t image = owen_scramble(begin, seed) >> (32 - digits);
        // Later digits must not matter.
        ASSERT_EQ(owen_scramble(begin | (seed_of(prefix) & tail), seed) >> (32 - digits), image);
        ASSERT_EQ(owen_scramble(begin | tail, seed) >> (32 - digits), image);
        images.insert(image);
      }
      EXPECT_EQ(images.size(), std::size_t{1} << digits);
    }
    std::set<std::uint32_t> low;  // and the last digits, below one prefix
    for (std::uint32_t v = 0; v < 4096; ++v) low.insert(owen_scramble(0xabcde000u | v, seed));
    EXPECT_EQ(low.size(), 4096u);
  }
}

TEST(OwenScramble, TurnsEveryDigitWithProbabilityOneHalf) {
  constexpr int kSeeds = 4096;
  for (const std::uint32_t value : {0u, 0x80000000u, 0x12345678u, 0xffffffffu}) {
    std::array<int, 32> turned{};
    for (std::uint64_t s = 0; s < kSeeds; ++s) {
      const std::uint32_t difference = owen_scramble(value, seed_of(s)) ^ value;
      for (int bit = 0; bit < 32; ++bit) turned[bit] += static_cast<int>((difference >> bit) & 1u);
    }
    for (int bit = 0; bit < 32; ++bit) EXPECT_NEAR(turned[bit], kSeeds / 2, 5 * 32) << "bit " << bit;
  }
}

TEST(OwenScramble, KeepsNets) {
  for (std::uint64_t s = 0; s < 20; ++s) {
    Points points = sobol_points(0, 8);
    for (Point& p : points) {
      for (int d = 0; d < kSobolDimensions; ++d) p[d] = owen_scramble(p[d], seed_of(10 * s + d));
    }
    EXPECT_TRUE(is_net(points)) << s;
  }
}

TEST(OwenScramble, LanesAgreeWithScalars) {
  U16 value, seed;
  for (int i = 0; i < kLanes; ++i) {
    value[i] = seed_of(i);
    seed[i] = seed_of(100 + i);
  }
  const U16 same_seed = owen_scramble(value, seed[0]), own_seed = owen_scramble(value, seed);
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_EQ(same_seed[i], owen_scramble(value[i], seed[0]));
    EXPECT_EQ(own_seed[i], owen_scramble(value[i], seed[i]));
  }
}

Points padded_points(std::uint32_t begin, int log2_count, std::uint32_t seed) {
  Points points(std::size_t{1} << log2_count);
  for (std::uint32_t i = 0; i < points.size(); i += kLanes) {
    const Sample4 sample = padded_sobol(std::bit_cast<U16>(lane_index()) + (begin + i), splat(seed));
    for (std::uint32_t lane = 0; lane < kLanes && i + lane < points.size(); ++lane) {
      for (int d = 0; d < kSobolDimensions; ++d) {
        EXPECT_GE(sample.u[d][lane], 0.0f);
        EXPECT_LT(sample.u[d][lane], 1.0f);
        points[i + lane][d] = to_fraction(sample.u[d][lane]);
      }
    }
  }
  return points;
}

TEST(PaddedSobol, EveryAlignedBlockIsANet) {
  for (std::uint64_t s = 0; s < 10; ++s) {
    for (const int k : {0, 1, 2, 4, 6, 9}) {
      for (const std::uint32_t block : {0u, 1u, 6u}) {
        EXPECT_TRUE(is_net(padded_points(block << k, k, seed_of(s))))
            << "seed " << s << ", 2^" << k << " points";
      }
    }
  }
}

TEST(PaddedSobol, SeedsGiveDifferentPoints) {
  std::set<Point> seen;
  for (std::uint64_t s = 0; s < 1000; ++s) {
    for (const Point& p : padded_points(0, 4, seed_of(s))) seen.insert(p);
  }
  EXPECT_EQ(seen.size(), 16000u);
}

TEST(PaddedSobol, LanesHaveSeedsOfTheirOwn) {
  U16 index, seed;
  for (int i = 0; i < kLanes; ++i) {
    index[i] = static_cast<std::uint32_t>(5 * i);
    seed[i] = seed_of(i);
  }
  const Sample4 together = padded_sobol(index, seed);
  for (int i = 0; i < kLanes; ++i) {
    const Sample4 alone = padded_sobol(splat(index[i]), splat(seed[i]));
    for (int d = 0; d < kSobolDimensions; ++d) EXPECT_EQ(together.u[d][i], alone.u[d][7]);
  }
}

TEST(PaddedSobol, GroupsOfDimensionsAreUncorrelated) {
  // Two groups over the same sixteen indices: the mean of the product of centred coordinates is 0.
  constexpr int kSeeds = 4000;
  for (int a = 0; a < kSobolDimensions; ++a) {
    for (int b = 0; b < kSobolDimensions; ++b) {
      double sum = 0.0;
      for (std::uint64_t s = 0; s < kSeeds; ++s) {
        const U16 index = std::bit_cast<U16>(lane_index());
        const Sample4 first = padded_sobol(index, splat(seed_of(2 * s)));
        const Sample4 second = padded_sobol(index, splat(seed_of(2 * s + 1)));
        sum += lane_sum((first.u[a] - 0.5f) * (second.u[b] - 0.5f));
      }
      // Each product has the variance 1 / 144.
      EXPECT_NEAR(sum, 0.0, 4.5 * std::sqrt(16.0 * kSeeds) / 12.0) << a << " and " << b;
    }
  }
}

Points grid_points(const SobolGrid& grid) {
  Points points(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    for (int d = 0; d < kSobolDimensions; ++d) points[i][d] = to_fraction(grid.u[d][i]);
  }
  return points;
}

TEST(SobolGrid, HasOnePointInEachCellInBlocksOfFourByFour) {
  for (const int k : {4, 5, 7, 8, 9, 11, 14}) {
    SobolGrid grid;
    fill_sobol_grid(grid, k, 77);
    ASSERT_EQ(grid.size(), std::size_t{1} << k);
    ASSERT_EQ(grid.columns_log2 + grid.rows_log2, k);
    std::set<std::pair<int, int>> cells;
    for (std::size_t begin = 0; begin < grid.size(); begin += 16) {
      std::set<std::pair<int, int>> blocks;
      for (std::size_t i = begin; i < begin + 16; ++i) {
        const int column = static_cast<int>(std::ldexp(grid.u[0][i], grid.columns_log2));
        const int row = static_cast<int>(std::ldexp(grid.u[1][i], grid.rows_log2));
        cells.insert({column, row});
        blocks.insert({column / 4, row / 4});
      }
      ASSERT_EQ(blocks.size(), 1u) << "points " << begin << " to " << begin + 15;
    }
    EXPECT_EQ(cells.size(), grid.size());
  }
}

TEST(SobolGrid, IsAnOwenScrambledSobolNet) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SobolGrid grid;
    fill_sobol_grid(grid, 10, seed);
    const Points points = grid_points(grid), original = sobol_points(0, 10);
    EXPECT_TRUE(is_net(points));
    for (int a = 0; a <= 3; ++a) {
      for (int b = 0; b <= 3; ++b) {
        for (int c = 0; c <= 3; ++c) {
          const std::array<int, kSobolDimensions> digits = {a, b, c, 10 - a - b - c};
          EXPECT_EQ(sorted_counts(points, digits), sorted_counts(original, digits)) << a << b << c;
        }
      }
    }
  }
}

TEST(SobolGrid, RefillsAndRepeats) {
  SobolGrid grid, again;
  fill_sobol_grid(grid, 12, 5);
  fill_sobol_grid(grid, 8, 9);
  fill_sobol_grid(again, 8, 9);
  for (int d = 0; d < kSobolDimensions; ++d) EXPECT_EQ(grid.u[d], again.u[d]);
  fill_sobol_grid(again, 8, 10);
  EXPECT_NE(grid.u[0], again.u[0]);
  EXPECT_THROW(fill_sobol_grid(grid, 3, 1), std::logic_error);
  EXPECT_THROW(fill_sobol_grid(grid, 21, 1), std::logic_error);
}

struct Integrand {
  std::function<double(double, double, double, double)> f;
  double integral;
};

double at(const Integrand& integrand, const SobolGrid& grid, std::size_t i) {
  return integrand.f(grid.u[0][i], grid.u[1][i], grid.u[2][i], grid.u[3][i]);
}

TEST(SobolGrid, LanesAreUnbiasedAndTheirSpreadBoundsTheVariance) {
  constexpr int kSeeds = 600;
  const Integrand integrands[] = {{[](double x, double, double, double) { return x; }, 0.5},
                                  {[](double, double y, double, double) { return y * y; }, 1.0 / 3.0},
                                  {[](double x, double y, double, double) { return x * y; }, 0.25},
                                  {[](double x, double, double z, double w) { return x * z * w; }, 0.125}};
  for (const Integrand& integrand : integrands) {
    std::array<double, kLanes> sum{}, squared{};
    double squared_error = 0.0, estimated = 0.0;
    for (std::uint64_t s = 0; s < kSeeds; ++s) {
      SobolGrid grid;
      fill_sobol_grid(grid, 8, hash(4711, s));
      std::array<double, kLanes> lane{};
      for (std::size_t i = 0; i < grid.size(); ++i)
        lane[i % kLanes] += at(integrand, grid, i) * kLanes / 256.0;
      double mean = 0.0, spread = 0.0;
      for (int l = 0; l < kLanes; ++l) {
        sum[l] += lane[l];
        squared[l] += lane[l] * lane[l];
        mean += lane[l] / kLanes;
      }
      for (const double v : lane) spread += (v - mean) * (v - mean) / (kLanes - 1);
      squared_error += (mean - integrand.integral) * (mean - integrand.integral);
      estimated += spread / kLanes;
    }
    for (int l = 0; l < kLanes; ++l) {
      const double mean = sum[l] / kSeeds;
      const double deviation = std::sqrt((squared[l] / kSeeds - mean * mean) / kSeeds);
      EXPECT_NEAR(mean, integrand.integral, 4.5 * deviation) << "lane " << l;
    }
    EXPECT_LT(squared_error, estimated);
  }
}

TEST(SobolGrid, ErrorFallsFasterThanThePowerMinusNineTenths) {
  constexpr double kE = std::numbers::e;
  const Integrand integrands[] = {
      {[](double x, double y, double, double) { return std::exp(x - y); }, (kE - 1) * (1 - 1 / kE)},
      {[](double x, double y, double z, double w) { return (0.5 + x) * std::exp(y) * (1 + z * w); },
       (kE - 1) * 1.25}};
  for (const Integrand& integrand : integrands) {
    const auto rms_error = [&](int log2_count) {
      double squared = 0.0;
      SobolGrid grid;
      for (std::uint64_t s = 0; s < 24; ++s) {
        fill_sobol_grid(grid, log2_count, hash(31, s));
        double sum = 0.0;
        for (std::size_t i = 0; i < grid.size(); ++i) sum += at(integrand, grid, i);
        const double error = sum / static_cast<double>(grid.size()) - integrand.integral;
        squared += error * error / 24.0;
      }
      return std::sqrt(squared);
    };
    const double order = std::log2(rms_error(8) / rms_error(14)) / 6.0;
    EXPECT_GT(order, 0.9);
  }
}

}  // namespace
}  // namespace vrc
