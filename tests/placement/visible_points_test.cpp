// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/visible_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "placement_support.h"
#include "support.h"

namespace vrc {
namespace {

using MakePoints = VisiblePoints (*)(const SceneCharts&, const PlacementView&, std::uint64_t&);

struct SeenScene {
  Scene scene;
  SceneCharts charts{scene};
  FilmSampler film{scene.camera(), scene.film(), 16, 1};
  PlacementView view;
  std::uint64_t camera_rays = 0;
  VisiblePoints points;

  SeenScene(const std::string& name, int width, int height, const std::array<int, 4>& window,
            MakePoints make = pixel_centres)
      : scene(test::load_scene(name, width, height)),
        view{window[0], window[1], window[2], window[3], &film},
        points(make(charts, view, camera_rays)) {}
};

/// Film coordinates that a point is seen at.
Vec2 on_film(const Camera& camera, const Vec3& x) {
  const Vec3 d = x - camera.origin;
  const double scale = camera.width / (2.0 * camera.tan_half_width * d.dot(camera.forward));
  return {0.5 * camera.width + scale * d.dot(camera.right), 0.5 * camera.height - scale * d.dot(camera.up)};
}

TEST(PixelCentres, SeeEveryReflectingPixelOnceFromCoarseToFine) {
  const SeenScene s("half_box.xml", 64, 64, {3, 5, 48, 36});
  EXPECT_EQ(s.camera_rays, 45u * 31u);
  std::set<std::pair<int, int>> seen;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const Vec2 at = on_film(s.scene.camera(), s.points.position(i));
    const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
    EXPECT_NEAR(at.x(), x + 0.5, 1e-3);
    EXPECT_NEAR(at.y(), y + 0.5, 1e-3);
    EXPECT_TRUE(seen.insert({x, y}).second);
    const auto expected = s.scene.seen_at(x + 0.5, y + 0.5);
    ASSERT_TRUE(expected.has_value());
    EXPECT_EQ(s.points.region(i), expected->region);
    EXPECT_LT((s.points.surface_point(i).position - expected->position).norm(), 1e-4);
    EXPECT_TRUE(s.points.is_open(i));
  }
  std::size_t reflecting = 0;
  for (int y = 5; y < 36; ++y) {
    for (int x = 3; x < 48; ++x) reflecting += s.scene.seen_at(x + 0.5, y + 0.5).has_value();
  }
  EXPECT_EQ(seen.size(), reflecting);
  // 31 rows allow pilot records 2 pixels apart.
  for (std::size_t i = 0; i < s.points.pilot_count(); ++i) {
    const Vec2 at = on_film(s.scene.camera(), s.points.position(i));
    EXPECT_EQ(static_cast<int>(at.x() - 3) % 2, 0);
    EXPECT_EQ(static_cast<int>(at.y() - 5) % 2, 0);
  }
  EXPECT_GT(s.points.pilot_count(), 50u);
}

TEST(PixelCentres, HaveKeysOfTheFilmNotOfTheWindow) {
  const SeenScene all("half_box.xml", 32, 32, {0, 0, 32, 32}), part("half_box.xml", 32, 32, {8, 4, 30, 20});
  std::map<std::uint64_t, Vec3> positions;
  for (std::size_t i = 0; i < all.points.size(); ++i) positions[all.points.key(i)] = all.points.position(i);
  EXPECT_EQ(positions.size(), all.points.size());
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    ASSERT_TRUE(positions.contains(part.points.key(i)));
    EXPECT_EQ(positions[part.points.key(i)], part.points.position(i));
  }
}

TEST(FilmPoints, AreSpreadOverTheWindowAndItsBeginnings) {
  const SeenScene s("cornell_glossy.xml", 128, 128, {16, 32, 112, 128}, film_points);
  EXPECT_NEAR(static_cast<double>(s.camera_rays), 0.5 * 96 * 96, 1.0);
  for (const std::size_t count : {s.points.size() / 16, s.points.size()}) {
    std::array<int, 16> in_block{};
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2 at = on_film(s.scene.camera(), s.points.position(i)) - Vec2(16, 32);
      ASSERT_TRUE(at.minCoeff() > -1e-3 && at.maxCoeff() < 96.001);
      const auto block = [](double x) {
        return std::min(static_cast<std::size_t>(x / 24.0), std::size_t{3});
      };
      ++in_block[4 * block(at.y()) + block(at.x())];
    }
    const double share = static_cast<double>(count) / 16.0;
    for (const int n : in_block) EXPECT_NEAR(n, share, 0.2 * share + 3.0);
  }
}

ValidRegion random_region(const SurfacePoint& point, double largest, test::SeededBits& bits) {
  const Frame frame = Frame::around(point.normal);
  const double angle = 6.0 * bits.uniform(), size = largest * bits.uniform();
  ValidRegion region;
  region.center = point.position;
  region.normal = point.normal;
  region.axis1 = std::cos(angle) * frame.tangent + std::sin(angle) * frame.bitangent;
  region.axis2 = region.normal.cross(region.axis1);
  region.radius1 = size;
  region.radius2 = size * (0.1 + 0.9 * bits.uniform());
  region.normal_radius = region.radius2;
  region.cos_max_deviation = std::cos(0.1);
  return region;
}

void expect_cover_as_by_brute_force(const std::string& scene_name, bool normals_count = true) {
  SeenScene s(scene_name, 96, 96, {5, 0, 91, 90});
  test::SeededBits bits(3);
  std::size_t covered = 0;
  for (int run = 0; run < 60; ++run) {
    const SurfacePoint point = s.points.surface_point(bits.below(s.points.size()));
    ValidRegion region = random_region(point, 0.2 * s.scene.radius(), bits);
    region.normals_count = normals_count;
    const SurfaceReach reach = reach_over_surface(s.charts, point, region, 1.0);
    s.points.clear_coverage();
    s.points.cover(region, reach);
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      const SurfacePoint p = s.points.surface_point(i);
      const double k = joint_distance(region, p.position, p.normal);
      const double turned = p.normal.dot(region.normal) - region.cos_max_deviation;
      if (std::abs(k - 1.0) < 1e-3 || std::abs(turned) < 1e-6) continue;
      const bool inside = k < 1.0 && turned > 0.0;
      // These scenes have no two sheets in one smooth region.
      EXPECT_EQ(!s.points.is_open(i), inside && p.region == point.region) << "point " << i << ", run " << run;
      covered += inside;
    }
  }
  EXPECT_GT(covered, 1000u);
}

TEST(VisiblePoints, AreCoveredAsByBruteForce) { expect_cover_as_by_brute_force("cornell_glossy.xml"); }

TEST(VisiblePoints, AreCoveredAsByBruteForceOnCurvedSurfaces) {
  expect_cover_as_by_brute_force("curved_room.xml");
}

TEST(VisiblePoints, AreCoveredUpToTheLargestTurnWhereNormalsDoNotCount) {
  expect_cover_as_by_brute_force("curved_room.xml", false);
}

}  // namespace
}  // namespace vrc
