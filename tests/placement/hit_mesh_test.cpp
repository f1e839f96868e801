// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../placement/src/hit_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "placement/guide.h"
#include "placement_support.h"

namespace vrc {
namespace {

constexpr int kLog2Rays = 10;

/// A point in every cell of the Sobol grid, moved to where `warp` wants it.
void store_points(HitGrid& grid, const GuideWarp& warp) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (int column = 0; column < grid.columns(); column += 4) {
    for (int row = 0; row < grid.rows(); row += 4) {
      F16 u1{}, u2{};
      for (int i = 0; i < kLanes; ++i) {
        u1[i] = (static_cast<float>(column + i / 4) + uniform(random)) / static_cast<float>(grid.columns());
        u2[i] = (static_cast<float>(row + i % 4) + uniform(random)) / static_cast<float>(grid.rows());
      }
      GatherPacket16 packet{};
      const GuideWarp::Point16 moved = warp(u1, u2);
      packet.u1 = moved.u1;
      packet.u2 = moved.u2;
      packet.distance = splat(1.0f);
      grid.store(u1, u2, packet);
    }
  }
}

/// Bright in a band across the square, one row farther in every column.
GuideHistogram slanted_band() {
  GuideHistogram h;
  for (int c = 0; c < GuideHistogram::kColumns; ++c) {
    for (int r = 0; r < GuideHistogram::kRows; ++r) {
      const int off = (r - c) & (GuideHistogram::kRows - 1);
      h.mean_square[static_cast<std::size_t>(c * GuideHistogram::kRows + r)] = off < 4 ? 1.0f : 1e-4f;
    }
  }
  return h;
}

/// A point of the square as one of a disk, the azimuth going round it.
Vec2 on_disk(const HitGrid& grid, int cell) {
  const double radius = 0.1 + static_cast<double>(grid.field(HitGrid::kSquare1)[cell]);
  const double turn = 2.0 * kPi * static_cast<double>(grid.field(HitGrid::kSquare2)[cell]);
  return radius * Vec2(std::cos(turn), std::sin(turn));
}

/// Of the polygon around the axis.
bool is_in_one_column(const HitGrid& grid, const int (&corners)[3]) {
  const int stride = grid.index(1, 0);
  return corners[0] / stride == corners[1] / stride && corners[1] / stride == corners[2] / stride;
}

/// Twice the area of a triangle in the square whose second coordinate wraps; positive when counter-clockwise
/// around the axis.
double turned(const HitGrid& grid, const int (&corners)[3]) {
  const auto from_first = [&](int k) {
    const auto off = [&](HitGrid::Field f) {
      return static_cast<double>(grid.field(f)[corners[k]] - grid.field(f)[corners[0]]);
    };
    const double turn = off(HitGrid::kSquare2);
    return Vec2(off(HitGrid::kSquare1), turn - std::round(turn));
  };
  const Vec2 b = from_first(1), c = from_first(2);
  return b[0] * c[1] - b[1] * c[0];
}

void expect_disk(const GuideWarp& warp, const GatherStrategy& strategy) {
  HitGrid grid((kLog2Rays + 1) / 2, kLog2Rays / 2);
  store_points(grid, warp);
  const HitMesh mesh(grid, strategy);
  std::set<std::pair<int, int>> edges;
  std::set<int> used;
  double area = 0.0;
  std::size_t folded = 0;
  for (std::size_t first = 0; first < mesh.triangle_count(); first += kLanes) {
    const HitMesh::Triangles16 t = mesh.triangles(first);
    for (int lane = 0; lane < kLanes && first + static_cast<std::size_t>(lane) < mesh.triangle_count();
         ++lane) {
      const int corners[3] = {t[0][lane], t[1][lane], t[2][lane]};
      for (int e = 0; e < 3; ++e) {
        used.insert(corners[e]);
        EXPECT_TRUE(edges.emplace(corners[e], corners[(e + 1) % 3]).second) << "an edge twice, one way round";
      }
      folded += !is_in_one_column(grid, corners) && turned(grid, corners) <= 0.0;
      const Vec2 a = on_disk(grid, corners[0]), b = on_disk(grid, corners[1]), c = on_disk(grid, corners[2]);
      area += 0.5 * ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]);
    }
  }
  // All points of the strategy's loops are vertices, and what is no edge of two triangles goes once round the
  // disk.
  std::size_t points = 0;
  for (int column = 0; column < grid.columns(); ++column) {
    std::vector<int> own;
    for (int row = 0; row < grid.rows(); ++row) {
      const int cell = grid.index(column, row);
      const float u1 = grid.field(HitGrid::kSquare1)[cell];
      if (u1 >= strategy.begin && u1 < strategy.end) own.push_back(cell);
    }
    if (own.size() < 3) continue;  // no loop
    points += own.size();
    for (const int cell : own) EXPECT_TRUE(used.contains(cell)) << column;
  }
  std::map<int, int> border;
  for (const auto& [from, to] : edges) {
    if (!edges.contains({to, from})) border[from] = to;
  }
  EXPECT_EQ(mesh.triangle_count(), 2 * points - border.size() - 2);  // Euler's formula
  ASSERT_FALSE(border.empty());
  double border_area = 0.0;
  int at = border.begin()->first;
  for (std::size_t i = 0; i < border.size(); ++i) {
    ASSERT_TRUE(border.contains(at));
    const Vec2 p = on_disk(grid, at), q = on_disk(grid, border[at]);
    border_area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
    at = border[at];
  }
  EXPECT_EQ(at, border.begin()->first);
  EXPECT_NEAR(area, border_area, 1e-9);
  // Where rows are close together and points lie at random within their columns, some triangles fold, which
  // the others make up for.
  EXPECT_LT(folded, mesh.triangle_count() / 8);
  EXPECT_GT(border_area, 2.0);  // of some 2 pi (strategy.end + .1)^2 / 2
}

TEST(HitMesh, IsADiskWithoutAGuide) { expect_disk(GuideWarp(GuideHistogram{}, {0}), {}); }

TEST(HitMesh, IsADiskHoweverAGuideMovesTheRows) { expect_disk(GuideWarp(slanted_band(), {0}), {}); }

TEST(HitMesh, HoldsOneStrategyWhoseBordersAGuideMoves) {
  GuideHistogram band = slanted_band();
  for (std::size_t i = 0; i < GuideHistogram::kCells / 2; ++i) band.mean_square[i] *= 0.1f;
  GatherStrategy strategy;
  strategy.begin = 0.5f;
  const GuideWarp warp(band, {0, GuideHistogram::kColumns / 2});
  expect_disk(warp, strategy);
  strategy.begin = 0.0f;
  strategy.end = 0.5f;
  HitGrid grid((kLog2Rays + 1) / 2, kLog2Rays / 2);
  store_points(grid, warp);
  EXPECT_LT(HitMesh(grid, strategy).triangle_count(), std::size_t{800});  // of 2^10 times one half
}

TEST(HitMesh, LinksTheNearestAzimuthsOfNeighbouringLoops) {
  HitGrid grid((kLog2Rays + 1) / 2, kLog2Rays / 2);
  store_points(grid, GuideWarp(slanted_band(), {0}));
  const HitMesh mesh(grid, {});
  const auto azimuth = [&](int cell) { return grid.field(HitGrid::kSquare2)[cell]; };
  for (int column = 1; column + 1 < grid.columns(); ++column) {
    for (int row = 0; row < grid.rows(); ++row) {
      const int cell = grid.index(column, row);
      for (const auto& [link, other] :
           {std::pair(HitMesh::kInner, column - 1), std::pair(HitMesh::kOuter, column + 1)}) {
        const int linked = mesh.neighbours(link, splat(cell))[0];
        const auto distance = [&](int to) {
          const float d = std::abs(azimuth(to) - azimuth(cell));
          return std::min(d, 1.0f - d);
        };
        float nearest = 1.0f;
        for (int r = 0; r < grid.rows(); ++r) nearest = std::min(nearest, distance(grid.index(other, r)));
        ASSERT_GE(linked, grid.index(other, 0));
        ASSERT_LT(linked, grid.index(other, grid.rows()));
        // The seam at azimuth 0 is joined as it comes.
        if (azimuth(cell) > 0.2f && azimuth(cell) < 0.8f) {
          EXPECT_FLOAT_EQ(distance(linked), nearest);
        }
      }
      const int next = mesh.neighbours(HitMesh::kNext, splat(cell))[0];
      EXPECT_EQ(mesh.neighbours(HitMesh::kPrevious, splat(next))[0], cell);
    }
  }
}

}  // namespace
}  // namespace vrc
