// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/pixel_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "placement_support.h"
#include "support.h"

namespace vrc {
namespace {

struct GridOfScene {
  Scene scene;
  FilmSampler film{scene.camera(), scene.film(), 16, 1};
  PlacementView view;
  std::uint64_t camera_rays = 0;
  PixelGrid grid{scene, view, camera_rays};

  GridOfScene(const std::string& name, int width, int height, int x0, int y0, int x1, int y1)
      : scene(test::load_scene(name, width, height)), view{x0, y0, x1, y1, &film} {}
};

TEST(PixelGrid, OrdersAllPixelsFromCoarseToFine) {
  const GridOfScene g("half_box.xml", 64, 64, 3, 5, 48, 36);
  const PixelGrid& grid = g.grid;
  ASSERT_EQ(grid.width(), 45);
  ASSERT_EQ(grid.height(), 31);
  EXPECT_EQ(g.camera_rays, 45u * 31u);
  std::vector<std::uint32_t> sorted = grid.order();
  std::ranges::sort(sorted);
  std::vector<std::uint32_t> all(grid.size());
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(sorted, all);
  for (const int stride : {32, 16, 8, 4, 2, 1}) {
    std::set<std::uint32_t> lattice;
    for (int y = 0; y < grid.height(); y += stride) {
      for (int x = 0; x < grid.width(); x += stride)
        lattice.insert(static_cast<std::uint32_t>(y * grid.width() + x));
    }
    ASSERT_EQ(grid.lattice_prefix(stride), lattice.size());
    const auto end = grid.order().begin() + static_cast<std::ptrdiff_t>(lattice.size());
    EXPECT_EQ(std::set<std::uint32_t>(grid.order().begin(), end), lattice) << "stride " << stride;
  }
}

TEST(PixelGrid, SeesThePixelCentres) {
  const GridOfScene g("half_box.xml", 64, 48, 10, 4, 60, 44);
  int seen = 0;
  for (std::size_t i = 0; i < g.grid.size(); ++i) {
    const int x = 10 + static_cast<int>(i) % 50, y = 4 + static_cast<int>(i) / 50;
    const auto found = g.grid.surface_point(g.scene, i);
    const auto expected = test::seen_at(g.scene, x + 0.5, y + 0.5);
    ASSERT_EQ(found.has_value(), expected.has_value()) << x << ' ' << y;
    EXPECT_EQ(g.grid.is_open(i), expected.has_value());
    if (!found) continue;
    ++seen;
    EXPECT_LT((found->position - expected->position).norm(), 1e-4);
    EXPECT_EQ(found->region, expected->region);
  }
  EXPECT_GT(seen, 1000);
}

TEST(PixelGrid, HasKeysOfTheFilmNotOfTheWindow) {
  const GridOfScene all("half_box.xml", 32, 32, 0, 0, 32, 32), part("half_box.xml", 32, 32, 8, 4, 30, 20);
  std::set<std::uint64_t> keys;
  for (std::size_t i = 0; i < all.grid.size(); ++i) keys.insert(all.grid.key(i));
  EXPECT_EQ(keys.size(), all.grid.size());
  EXPECT_EQ(part.grid.key(0), all.grid.key(4 * 32 + 8));
  EXPECT_EQ(part.grid.key(22), all.grid.key(5 * 32 + 8));
}

/// Pixels that a brute-force test marks; those within round-off of the border are left to either side.
struct Marks {
  std::set<std::size_t> inside, border;
};

Marks brute_force(const GridOfScene& g, const ValidRegion& region, std::int32_t smooth_region) {
  Marks marks;
  for (std::size_t i = 0; i < g.grid.size(); ++i) {
    const auto p = g.grid.surface_point(g.scene, i);
    if (!p || p->region != smooth_region) continue;
    const double kt = translation_distance(region, p->position);
    const double turn = (1.0 - region.normal.dot(p->normal)) / (1.0 - region.cos_max_deviation);
    const double k2 = kt * kt + turn;
    if (std::abs(k2 - 1.0) < 2e-3) {
      marks.border.insert(i);
    } else if (k2 < 1.0) {
      marks.inside.insert(i);
    }
  }
  return marks;
}

void expect_cover_as_by_brute_force(const std::string& scene_name) {
  GridOfScene g(scene_name, 96, 96, 5, 0, 91, 90);
  test::SeededBits bits(3);
  std::size_t covered = 0;
  for (int run = 0; run < 60; ++run) {
    const auto point = g.grid.surface_point(g.scene, bits.below(g.grid.size()));
    if (!point) continue;
    const Frame frame = Frame::around(point->normal);
    const double angle = 6.0 * bits.uniform(), size = 0.2 * g.scene.radius() * bits.uniform();
    ValidRegion region;
    region.center = point->position;
    region.normal = point->normal;
    region.axis1 = std::cos(angle) * frame.tangent + std::sin(angle) * frame.bitangent;
    region.axis2 = region.normal.cross(region.axis1);
    region.radius1 = size;
    region.radius2 = size * (0.1 + 0.9 * bits.uniform());
    region.normal_radius = region.radius2;
    region.cos_max_deviation = std::cos(0.1);

    const Marks expected = brute_force(g, region, point->region);
    g.grid.clear_coverage();
    g.grid.cover(region, point->region);
    for (std::size_t i = 0; i < g.grid.size(); ++i) {
      const bool marked = g.grid.surface_point(g.scene, i).has_value() && !g.grid.is_open(i);
      if (expected.border.contains(i)) continue;
      EXPECT_EQ(marked, expected.inside.contains(i)) << "pixel " << i << ", run " << run;
    }
    covered += expected.inside.size();
  }
  EXPECT_GT(covered, 1000u);
}

TEST(PixelGrid, CoversWhatABruteForceTestCovers) { expect_cover_as_by_brute_force("cornell_glossy.xml"); }

TEST(PixelGrid, CoversWhatABruteForceTestCoversOnCurvedSurfaces) {
  expect_cover_as_by_brute_force("curved_room.xml");
}

}  // namespace
}  // namespace vrc
