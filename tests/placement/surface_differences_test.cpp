// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/surface_differences.h"

#include <gtest/gtest.h>

#include <cmath>

#include "placement_support.h"

namespace vrc {
namespace {

TEST(DisplacedSite, MovesByTheDisplacementOnAPlane) {
  const Scene scene = test::load_scene("half_box.xml", 64, 64);
  const RecordSite site = test::sites_at(scene, {{0.5, 0.9}})[0];
  const Vec2 d(0.02, -0.05);
  const std::optional<RecordSite> moved = displaced_site(scene, site, d);
  ASSERT_TRUE(moved.has_value());
  const Vec3 expected = site.point.position + d[0] * site.frame.tangent + d[1] * site.frame.bitangent;
  EXPECT_LT((moved->point.position - expected).norm(), 1e-6);
  EXPECT_EQ(moved->key, site.key);
  EXPECT_LT((moved->to_camera + moved->point.position - scene.camera().origin).norm(), 1e-12);
  EXPECT_EQ(displaced_site(scene, site, Vec2::Zero())->point.position, site.point.position);
}

TEST(DisplacedSite, IsMissingBeyondBordersCreasesAndSilhouettes) {
  const Scene box = test::load_scene("half_box.xml", 64, 64);
  const RecordSite site = test::sites_at(box, {{0.5, 0.9}})[0];
  bool inside = false, outside = false;
  for (const double length : {0.01, 3.0}) {
    for (const Vec2& d : {Vec2(length, 0.0), Vec2(-length, 0.0), Vec2(0.0, length), Vec2(0.0, -length)}) {
      (length < 1.0 ? inside : outside) |= displaced_site(box, site, d).has_value();
    }
  }
  EXPECT_TRUE(inside);
  EXPECT_FALSE(outside);

  const Scene room = test::load_scene("curved_room.xml", 64, 64);
  const std::vector<RecordSite> pillar = test::sites_at(room, {{0.33, 0.64}});
  ASSERT_GT(pillar[0].point.shape_operator.norm(), 1.0);
  EXPECT_TRUE(surface_stencil(room, pillar[0], 0.005).has_value());
  EXPECT_FALSE(surface_stencil(room, pillar[0], 0.14).has_value());  // the pillar's radius is 0.13
}

TEST(SurfaceStencil, DifferentiatesAQuadraticFunctionOfThePosition) {
  const Scene scene = test::load_scene("half_box.xml", 64, 64);
  const RecordSite site = test::sites_at(scene, {{0.5, 0.9}})[0];
  const auto stencil = surface_stencil(scene, site, 0.03);
  ASSERT_TRUE(stencil.has_value());
  const Vec3 a(0.3, -1.0, 2.0), b(1.0, 0.4, -0.7);
  const Jet2 j = differentiate(
      *stencil, [&](const RecordSite& s) { return s.point.position.dot(a) * s.point.position.dot(b); });
  const Vec3 x = site.point.position;
  const auto tangential = [&](const Vec3& v) {
    return Vec2(v.dot(site.frame.tangent), v.dot(site.frame.bitangent));
  };
  const Vec2 at = tangential(a), bt = tangential(b);
  EXPECT_NEAR(j.value, x.dot(a) * x.dot(b), 1e-12);
  EXPECT_LT((j.gradient - (x.dot(a) * bt + x.dot(b) * at)).norm(), 1e-4);
  EXPECT_LT((j.hessian - (at * bt.transpose() + bt * at.transpose())).norm(), 1e-2);
}

}  // namespace
}  // namespace vrc
