// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/record_overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/parallel.h"
#include "geometry/shapes.h"
#include "placement/surface_reach.h"
#include "transport/scene.h"

namespace vrc {
namespace {

constexpr int kSize = 128;

/// Two walls that face the camera, 4 by 4 units: triangles 0 and 1 at z = 0, 2 and 3 hidden at z = -1.
SceneDescription two_walls() {
  SceneDescription scene;
  scene.camera = look_at(Vec3(0, 0, 5), Vec3::Zero(), Vec3::UnitY(), 50.0, kSize, kSize);
  scene.environment = Rgb::Ones();
  scene.materials = {{"matte", {LambertLobe{Rgb::Constant(0.5f)}}, true}};
  for (const double z : {0.0, -1.0}) {
    ShapeDescription wall;
    wall.soup = make_rectangle();
    for (Vec3& p : wall.soup.positions) p = Vec3(2.0 * p.x(), 2.0 * p.y(), z);
    wall.materials = {0};
    wall.emission = {Rgb::Zero()};
    scene.shapes.push_back(std::move(wall));
  }
  return scene;
}

RadianceRecord record_at(const Scene& scene, std::uint32_t triangle, const Vec2& radii) {
  RadianceRecord record;
  record.site = make_site(scene, scene.surface_point(triangle, 0.3f, 0.4f, scene.camera().origin), triangle);
  ValidRegion& region = record.region;
  region.center = record.site.point.position;
  region.normal = record.site.point.normal;
  region.axis1 = Vec3::UnitX();
  region.axis2 = -Vec3::UnitY();  // left-handed, as eigenvectors may be
  region.radius1 = radii.x();
  region.radius2 = radii.y();
  region.normal_radius = radii.minCoeff();
  region.cos_max_deviation = std::cos(0.1);
  return record;
}

class RecordOverlay : public testing::Test {
 protected:
  [[nodiscard]] Image draw(std::vector<RadianceRecord> records, double value = 0.0) const {
    Image picture(kSize, kSize, {"R", "G", "B"});
    std::ranges::fill(picture.pixels, static_cast<float>(value));
    const std::vector<SurfaceReach> reaches = reaches_of(*charts_, records, 3.0);
    return draw_record_overlay(picture, RadianceCache(charts_, std::move(records), reaches, brdfs_),
                               options_);
  }
  [[nodiscard]] Vec2 film(const Vec3& p) const {
    const Camera& camera = scene_.camera();
    const Vec3 d = p - camera.origin;
    const double scale = 1.0 / (camera.pixel_size() * d.dot(camera.forward));
    return {0.5 * kSize + scale * d.dot(camera.right), 0.5 * kSize - scale * d.dot(camera.up)};
  }

  Scene scene_{two_walls()};
  std::shared_ptr<const SceneCharts> charts_ = std::make_shared<const SceneCharts>(scene_);
  std::shared_ptr<const BrdfHarmonicsSet> brdfs_ =
      std::make_shared<const BrdfHarmonicsSet>(scene_.bsdfs(), 1);
  RecordOverlayOptions options_;
};

TEST_F(RecordOverlay, DrawsTheRimAndTheCentreOnly) {
  options_.scale = 1.0;
  const RadianceRecord record = record_at(scene_, 0, Vec2(0.8, 0.5));
  const Image image = draw({record});
  std::vector<Vec2> rim;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2.0 * kPi * i / 2000;
    rim.push_back(film(record.region.center + 0.8 * std::cos(angle) * Vec3::UnitX() +
                       0.5 * std::sin(angle) * Vec3::UnitY()));
  }
  const Vec2 center = film(record.region.center);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Vec2 p(x + 0.5, y + 0.5);
      double distance = 1e9;
      for (const Vec2& q : rim) distance = std::min(distance, (p - q).norm());
      const float blue = image.pixel(x, y)[2] / options_.taylor_color[2];
      const double line = std::clamp(0.5 * options_.line_width + 0.5 - distance, 0.0, 1.0);
      const double dot = std::clamp(options_.dot_radius + 0.5 - (p - center).norm(), 0.0, 1.0);
      EXPECT_NEAR(blue, std::max(line, dot), 0.15) << x << ", " << y;
    }
  }
}

TEST_F(RecordOverlay, LeavesOutWhatIsHidden) {
  const Image empty = draw({});
  EXPECT_EQ(draw({record_at(scene_, 2, Vec2(0.5, 0.5))}).pixels, empty.pixels);
  EXPECT_NE(draw({record_at(scene_, 1, Vec2(0.5, 0.5))}).pixels, empty.pixels);
}

TEST_F(RecordOverlay, ShowsTheClassInColours) {
  RadianceRecord record = record_at(scene_, 0, Vec2(1.0, 1.0));
  const auto brightest = [&](int channel) {
    const Image image = draw({record});
    float result = 0.0f;
    for (std::size_t i = 0; i < image.pixel_count(); ++i)
      result = std::max(result, image.pixels[3 * i + channel]);
    return result;
  };
  EXPECT_FLOAT_EQ(brightest(2), options_.taylor_color[2]);
  record.harmonics = std::make_shared<const RecordHarmonics>();
  record.harmonics_reason = HarmonicsReason::kTurns;
  EXPECT_FLOAT_EQ(brightest(0), options_.harmonics_color[0]);
  EXPECT_FLOAT_EQ(brightest(2), options_.harmonics_color[2]);
}

TEST_F(RecordOverlay, ClampsThePicture) {
  EXPECT_EQ(draw({}, 0.25).pixels.front(), 0.25f);
  EXPECT_EQ(draw({}, 4.0).pixels.front(), 1.0f);
  EXPECT_EQ(draw({}, std::nan("")).pixels.front(), 0.0f);
}

TEST_F(RecordOverlay, IsTheSameAtAnyNumberOfThreads) {
  std::vector<RadianceRecord> records;
  for (int i = 0; i < 50; ++i) records.push_back(record_at(scene_, i % 2, Vec2(0.02 * (i + 1), 0.7)));
  set_thread_count(1);
  const Image one = draw(records);
  set_thread_count(2);
  EXPECT_EQ(one.pixels, draw(records).pixels);
  set_thread_count(0);
}

TEST_F(RecordOverlay, UnfoldsLeftHandedRegionsToo) {
  const RadianceRecord record = record_at(scene_, 0, Vec2(2.0, 3.0));
  const SurfaceEllipse ellipse = surface_ellipse(scene_, record.site.point, record.region, 1.0);
  EXPECT_GT(ellipse.frame.tangent.cross(ellipse.frame.bitangent).dot(record.region.normal), 0.99);
  const SurfaceWalk walk = walk_surface(scene_.surface_mesh(0), ellipse);
  ASSERT_EQ(walk.faces.size(), 2u);  // both triangles of the wall, on either side of their diagonal
  const auto area = [](const WalkedFace& f) {
    const Vec2 a = f.corners[1] - f.corners[0], b = f.corners[2] - f.corners[0];
    return a.x() * b.y() - a.y() * b.x();
  };
  EXPECT_GT(area(walk.faces[0]), 0.0);
  EXPECT_GT(area(walk.faces[1]), 0.0);
}

}  // namespace
}  // namespace vrc
