// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/site_curvature.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "placement/place_records.h"
#include "placement_support.h"

namespace vrc {
namespace {

constexpr double kThetaMax = 0.15;

RadianceRecord record_on(const Scene& scene, const SurfacePoint& point, double radius1, double radius2,
                         double angle = 0.0) {
  RadianceRecord record;
  record.site = make_site(scene, point, 1);
  const Frame& frame = record.site.frame;
  const Vec3 axis = std::cos(angle) * frame.tangent + std::sin(angle) * frame.bitangent;
  record.region = {point.position,
                   point.normal,
                   axis,
                   point.normal.cross(axis),
                   radius1,
                   radius2,
                   std::min(radius1, radius2),
                   std::cos(kThetaMax)};
  record.estimate.hits.mean_inverse = 2.0;
  return record;
}

SurfacePoint point_on(const Scene& scene, double x, double y) {
  const auto seen = scene.seen_at(x * scene.camera().width, y * scene.camera().height);
  EXPECT_TRUE(seen.has_value());
  return *seen;
}

TEST(ClassifySite, PlanesAreFlat) {
  const Scene scene = test::load_scene("half_box.xml", 64, 64);
  const SceneCharts charts(scene);
  const SiteCurvature site =
      classify_site(charts, record_on(scene, point_on(scene, 0.5, 0.8), 0.3, 0.1), kThetaMax);
  EXPECT_EQ(site.reason, CurvatureReason::kFlat);
  EXPECT_FALSE(site.needs_sh());
  EXPECT_EQ(site.deviation, 0.0);
  EXPECT_EQ(site.curvature, 0.0);
  EXPECT_EQ(site.exponent, 100.0);
}

/// On a sphere of radius r an ellipse turns the normal by R1 / r to first order, by asin(R1 / r) or
/// R1 / r at its ends.
TEST(ClassifySite, SpheresTurnByTheEllipseOverTheRadius) {
  const Scene scene = test::load_scene("curved_room.xml", 256, 256);
  const SceneCharts charts(scene);
  SurfacePoint point;  // on the large ball
  for (int y = 0; y < 256 && point.shape_operator.norm() == 0.0; ++y) {
    const auto seen = scene.seen_at(0.66 * 256, y);
    if (seen && (seen->position - Vec3(0.68, 0.2, 0.62)).norm() < 0.21) point = *seen;
  }
  ASSERT_GT(point.shape_operator.norm(), 0.0);
  for (const double radius : {0.01, 0.02, 0.025, 0.035, 0.06}) {
    const SiteCurvature site =
        classify_site(charts, record_on(scene, point, radius, 0.3 * radius, 0.7), kThetaMax);
    const double turn = radius / 0.2;
    EXPECT_NEAR(site.curvature, 5.0, 0.1);
    EXPECT_NEAR(site.relative_curvature, 2.5, 0.05);
    EXPECT_NEAR(site.deviation, turn, 0.03 * turn);
    EXPECT_EQ(site.needs_sh(), turn > kThetaMax) << radius;
    EXPECT_EQ(site.reason, turn > kThetaMax ? CurvatureReason::kEllipseTurns : CurvatureReason::kTurnsLittle);
  }
}

/// A plane that bends only at a distance: the shape operator at the centre does not know.
TEST(ClassifySite, TheWalkMeetsBendsThatTheCentreDoesNotHave) {
  SceneDescription description;
  ShapeDescription shape;
  constexpr int kColumns = 40;
  for (int i = 0; i <= kColumns; ++i) {
    const double s = 0.05 * i;
    // Straight up to 1, then an arc of radius 1.
    const Vec2 p = s < 1.0 ? Vec2(s, 0.0) : Vec2(1.0 + std::sin(s - 1.0), -(1.0 - std::cos(s - 1.0)));
    shape.soup.positions.emplace_back(p.x(), 0.0, p.y());
    shape.soup.positions.emplace_back(p.x(), 1.0, p.y());
  }
  for (std::uint32_t i = 0; i < kColumns; ++i)
    shape.soup.add_face(std::vector<std::uint32_t>{2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  shape.materials = {0};
  description.shapes = {shape};
  description.materials = {{"matte", {LambertLobe{}}, true}};
  description.camera.origin = Vec3(0.5, 0.5, 10.0);
  const Scene scene(description);
  const SceneCharts charts(scene);
  const SurfacePoint center = scene.surface_point(2 * 14, 0.3f, 0.3f, description.camera.origin);
  ASSERT_LT(center.position.x(), 0.8);
  const SiteCurvature near = classify_site(charts, record_on(scene, center, 0.1, 0.1), kThetaMax);
  EXPECT_EQ(near.reason, CurvatureReason::kFlat);
  const SiteCurvature far = classify_site(charts, record_on(scene, center, 0.8, 0.8), kThetaMax);
  EXPECT_EQ(far.reason, CurvatureReason::kSurfaceTurns);
  EXPECT_TRUE(far.needs_sh());
  EXPECT_NEAR(far.deviation, center.position.x() + 0.8 - 1.0, 0.05);
}

TEST(ClassifySite, EveryPlacedRecordHasItsClass) {
  const Scene scene = test::load_scene("curved_room.xml", 64, 64);
  const FilmSampler film(scene.camera(), scene.film(), 16, 1);
  CacheOptions options;
  options.error = 0.2;
  options.gather_rays = 1024;
  std::array<int, kCurvatureReasons> count{};
  for (const RadianceRecord& r : place_records(scene, {0, 0, 64, 64, &film}, options, 1, 1, {}).records) {
    ++count[static_cast<std::size_t>(r.curvature.reason)];
    EXPECT_EQ(r.curvature.needs_sh(), r.curvature.deviation > options.turning_angle());
    EXPECT_EQ(r.curvature.reason == CurvatureReason::kFlat, r.curvature.deviation <= 1e-6);
  }
  EXPECT_GT(count[static_cast<std::size_t>(CurvatureReason::kFlat)], 100);
  EXPECT_GT(count[static_cast<std::size_t>(CurvatureReason::kEllipseTurns)], 10);
}

TEST(ClassifySite, IsLeftOutWhereNobodyAsks) {
  const Scene scene = test::load_scene("curved_room.xml", 64, 64);
  const FilmSampler film(scene.camera(), scene.film(), 16, 1);
  CacheOptions options;
  options.error = 0.2;
  const auto place = [&] { return place_records(scene, {0, 0, 64, 64, &film}, options, 1, 1, {}).records; };
  const std::vector<RadianceRecord> with = place();
  options.classify_sites = false;
  const std::vector<RadianceRecord> without = place();
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].radiance[1].value, without[i].radiance[1].value);
    EXPECT_EQ(with[i].region.radius1, without[i].region.radius1);
    if (!without[i].uses_harmonics()) {
      EXPECT_EQ(without[i].curvature.deviation, 0.0);
    }
  }
}

TEST(ClassifySite, ReasonsHaveNames) {
  EXPECT_EQ(name_of(CurvatureReason::kFlat), "flat");
  EXPECT_EQ(name_of(CurvatureReason::kSurfaceTurns), "surface-turns");
}

}  // namespace
}  // namespace vrc
