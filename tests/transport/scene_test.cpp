// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/scene.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "statistics.h"
#include "test_scenes.h"

namespace vrc {
namespace {

constexpr auto kIncoherent = RayTracer::Coherence::kIncoherent;

Scene cube_scene() {
  SceneDescription description;
  add_shape(description, make_cube(), matte(0.5f), 0.0f, false);
  return Scene(description);
}

/// A smooth ball beside a glossy cube and a two-sided floor.
SceneDescription mixed_description() {
  SceneDescription description;
  add_shape(description, make_sphere(Vec3::Zero(), 1.0, 6), matte(0.5f), 0.0f, false);
  add_shape(description, placed(make_cube(), Vec3(0.5, 0.5, 0.5), Vec3(2, 0, 0)), {"metal", {GgxLobe{}}});
  add_shape(description, placed(make_rectangle(), Vec3(4, 4, 1), Vec3(0, 0, -1.5)), matte(0.3f, true));
  return description;
}

TEST(Scene, RefusesWhatCannotBeRendered) {
  EXPECT_THROW(Scene{SceneDescription{}}, InputError);
  SceneDescription no_faces;
  add_shape(no_faces, PolygonSoup{}, matte(0.5f));
  EXPECT_THROW(Scene{no_faces}, InputError);
}

TEST(Scene, RadiusIsThatOfTheBoundingSphere) {
  EXPECT_NEAR(cube_scene().radius(), std::sqrt(3.0), 1e-12);
  SceneDescription two;
  add_shape(two, placed(make_rectangle(), Vec3(1, 1, 1), Vec3(-9, 0, 0)), matte(0.5f));
  add_shape(two, placed(make_rectangle(), Vec3(1, 1, 1), Vec3(9, 0, 0)), matte(0.5f));
  EXPECT_NEAR(Scene(two).radius(), std::hypot(10.0, 1.0), 1e-12);
}

TEST(Scene, CubeHasARegionForEachFace) {
  const Scene scene = cube_scene();
  ASSERT_EQ(scene.triangle_count(), 12u);
  std::set<std::int32_t> regions;
  for (const SceneTriangle& t : scene.triangles()) regions.insert(t.region);
  EXPECT_EQ(regions.size(), 6u);
  for (const SceneTriangle& t : scene.triangles()) {
    for (const SceneTriangle& o : scene.triangles()) {
      const bool parallel = Eigen::Map<const Vec3f>(t.normal).dot(Eigen::Map<const Vec3f>(o.normal)) > 0.99f;
      EXPECT_EQ(t.region == o.region, parallel);
    }
  }
}

TEST(Scene, ShapesDoNotShareRegionsOrMaterials) {
  const Scene scene(mixed_description());
  std::set<std::pair<std::int32_t, std::int32_t>> pairs;
  std::set<std::int32_t> regions;
  for (const SceneTriangle& t : scene.triangles()) {
    pairs.insert({t.material, t.region});
    regions.insert(t.region);
  }
  EXPECT_EQ(regions.size(), 1u + 6u + 1u);
  EXPECT_EQ(pairs.size(), regions.size()) << "a region has one material";
}

TEST(Scene, OneSidedSurfacesDoNotScatterAtTheBack) {
  SceneDescription description;
  add_shape(description, make_rectangle(), matte(0.5f, false));
  add_shape(description, placed(make_rectangle(), Vec3(1, 1, 1), Vec3(5, 0, 0)), matte(0.5f, true));
  add_shape(description, placed(make_rectangle(), Vec3(1, 1, 1), Vec3(10, 0, 0)),
            Material{"black", {}, true});
  const Scene scene(description);
  struct Case {
    double x;
    bool front, back;
  };
  for (const Case& c : {Case{0, true, false}, Case{5, true, true}, Case{10, false, false}}) {
    const auto from = [&](double z) {
      return scene.intersect(splat(-1), ray16(Vec3(c.x + 0.1, 0.2, z), Vec3(0, 0, -z)), kIncoherent);
    };
    const SurfacePoint16 front = from(2.0), back = from(-2.0);
    EXPECT_TRUE(all(front.hit) && all(back.hit));
    EXPECT_EQ(any(front.scatters), c.front) << c.x;
    EXPECT_EQ(any(back.scatters), c.back) << c.x;
    EXPECT_GT(front.geometric_normal.z[0], 0.99f);
    EXPECT_LT(back.geometric_normal.z[0], -0.99f);
  }
}

TEST(Scene, RaysThatMissHaveNoSurface) {
  const SurfacePoint16 p =
      cube_scene().intersect(splat(-1), ray16(Vec3(0, 0, 3), Vec3(0, 0, 1)), kIncoherent);
  EXPECT_FALSE(any(p.hit));
  EXPECT_FALSE(any(p.scatters));
  EXPECT_TRUE(all(p.light < 0));
}

/// Random rays into the mixed scene; calls body(surface point of a lane, lane, origin, direction).
template <typename Body>
int for_random_hits(const Scene& scene, const Body& body) {
  Random random(31);
  int hits = 0;
  for (int packet = 0; packet < 500; ++packet) {
    V3x16 origin, direction;
    for (int i = 0; i < kLanes; ++i) {
      set_lane(origin, i, 3.0 * random.direction());
      set_lane(direction, i,
               random.uniform(0.5, 2.0) * (2.5 * random.uniform() * random.direction() - lane(origin, i)));
    }
    const SurfacePoint16 p = scene.intersect(splat(-1), {origin, direction, splat(1e17f)}, kIncoherent);
    for (int i = 0; i < kLanes; ++i) {
      if (p.hit[i] == 0) continue;
      ++hits;
      body(p, i, lane(origin, i), lane(direction, i));
    }
  }
  return hits;
}

TEST(Scene, NormalsFaceTheViewer) {
  const Scene scene(mixed_description());
  const int hits =
      for_random_hits(scene, [&](const SurfacePoint16& p, int i, const Vec3&, const Vec3& direction) {
        const Vec3 to_viewer = -direction.normalized();
        ASSERT_NEAR(lane(p.normal, i).norm(), 1.0, 1e-5);
        ASSERT_NEAR(lane(p.geometric_normal, i).norm(), 1.0, 1e-5);
        ASSERT_GE(lane(p.geometric_normal, i).dot(to_viewer), -1e-6);
        ASSERT_GT(lane(p.normal, i).dot(to_viewer), 5e-4);
      });
  EXPECT_GT(hits, 4000);
}

TEST(Scene, SmoothNormalsFollowTheSphere) {
  SceneDescription description;
  add_shape(description, make_sphere(Vec3(1, 2, 3), 2.0, 24), matte(0.5f), 0.0f, false);
  const Scene scene(description);
  Random random(8);
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Vec3 w = random.direction();
    const SurfacePoint16 p = scene.intersect(splat(-1), ray16(Vec3(1, 2, 3) + 5.0 * w, -w), kIncoherent);
    ASSERT_TRUE(all(p.hit));
    worst = std::max(worst, (lane(p.normal, 0) - w).norm());
    EXPECT_EQ(p.region[0], 0);
  }
  EXPECT_LT(worst, 0.002) << "interpolated, not faceted";
}

/// Normal curvature, in units of 1 / `unit`, where a ray meets the scene; all lengths are in the unit.
float curvature_at(const Scene& scene, double unit, const Vec3& from, const Vec3& ray, const Vec3& along) {
  const SurfacePoint16 p = scene.intersect(splat(-1), ray16(unit * from, ray), kIncoherent);
  EXPECT_TRUE(all(p.hit));
  return static_cast<float>(unit) * scene.normal_curvature(p.triangle, splat3(along), p.geometric_normal)[0];
}

TEST(Scene, NormalCurvatureOfSpheresInAnyUnit) {
  for (const double unit : {1e-4, 1.0, 1e4}) {
    SceneDescription description;
    add_shape(description, make_sphere(Vec3::Zero(), 2.0 * unit), matte(0.5f), 0.0f, false);
    const Scene scene(description);
    Random random(5);
    for (int k = 0; k < 100; ++k) {
      const Vec3 w = random.direction(), along = random.direction();
      EXPECT_NEAR(curvature_at(scene, unit, 3.0 * w, -w, along), 0.5, 0.02) << "outside, unit " << unit;
      EXPECT_NEAR(curvature_at(scene, unit, Vec3::Zero(), w, along), -0.5, 0.02) << "inside, unit " << unit;
    }
  }
}

TEST(Scene, NormalCurvatureOfPillarsAndCubes) {
  SceneDescription description;
  add_shape(description, make_cylinder(Vec3(9, 0, -1), Vec3(9, 0, 1), 0.5), matte(0.5f), 0.0f, false);
  add_shape(description, placed(make_cube(), Vec3(1, 1, 1), Vec3(20, 0, 0)), matte(0.5f), 0.0f, false);
  const Scene scene(description);
  const Vec3 beside(12, 0, 0.1), towards = -Vec3::UnitX();
  EXPECT_NEAR(curvature_at(scene, 1.0, beside, towards, Vec3::UnitY()), 2.0, 0.02);
  EXPECT_NEAR(curvature_at(scene, 1.0, beside, towards, Vec3::UnitZ()), 0.0, 1e-3);
  EXPECT_NEAR(curvature_at(scene, 1.0, beside, towards, Vec3(1, 1, 1)), 1.0, 0.02);
  EXPECT_EQ(curvature_at(scene, 1.0, Vec3(25, 0.1, 0), towards, Vec3::UnitY()), 0.0f);
  // Lanes of either kind.
  const SurfacePoint16 pillar = scene.intersect(splat(-1), ray16(beside, towards), kIncoherent);
  const SurfacePoint16 cube = scene.intersect(splat(-1), ray16(Vec3(25, 0.1, 0), towards), kIncoherent);
  const I16 even = (lane_index() & 1) == 0;
  const F16 k = scene.normal_curvature(select(even, pillar.triangle, cube.triangle), splat3(Vec3::UnitY()),
                                       splat3(Vec3::UnitX()));
  for (int i = 0; i < kLanes; ++i) EXPECT_NEAR(k[i], i % 2 == 0 ? 2.0 : 0.0, 0.02);
}

TEST(Scene, HitPointLiesOnTheRay) {
  const Scene scene(mixed_description());
  for_random_hits(scene, [&](const SurfacePoint16& p, int i, const Vec3& origin, const Vec3& direction) {
    const double grazing = std::abs(lane(p.geometric_normal, i).dot(direction.normalized()));
    if (grazing < 0.05) return;
    ASSERT_LT((origin + p.t[i] * direction - lane(p.position, i)).norm(), 2e-5 / grazing);
  });
}

TEST(Scene, SurfacePointAgreesWithTheRay) {
  const Scene scene(mixed_description());
  for_random_hits(scene, [&](const SurfacePoint16& p, int i, const Vec3& origin, const Vec3&) {
    const SurfacePoint q =
        scene.surface_point(static_cast<std::uint32_t>(p.triangle[i]), p.u[i], p.v[i], origin);
    ASSERT_LT((q.position - lane(p.position, i)).norm(), 2e-6);
    ASSERT_EQ(q.material, p.material[i]);
    ASSERT_EQ(q.region, p.region[i]);
    if (std::abs(q.geometric_normal.dot((origin - q.position).normalized())) < 1e-4) return;
    ASSERT_LT((q.geometric_normal - lane(p.geometric_normal, i)).norm(), 2e-6);
    ASSERT_LT((q.normal - lane(p.normal, i)).norm(), 5e-4);
    ASSERT_GT(q.normal.dot(origin - q.position), 0.0);
  });
}

TEST(Scene, LiftedPointsSeeOverTheirOwnSurface) {
  const Scene scene(mixed_description());
  for_random_hits(scene, [&](const SurfacePoint16& p, int i, const Vec3&, const Vec3&) {
    const Vec3 lifted = lane(scene.lifted(p), i);
    const double height = (lifted - lane(p.position, i)).dot(lane(p.geometric_normal, i));
    ASSERT_NEAR(height, scene.ray_offset(), 1e-6);
    const Ray16 back = ray16(lifted, -lane(p.geometric_normal, i), 10.0f * scene.ray_offset());
    ASSERT_TRUE(any(scene.tracer().occluded(splat(-1), back, kIncoherent)));
    const Ray16 away = ray16(lifted, lane(p.geometric_normal, i), 10.0f * scene.ray_offset());
    ASSERT_FALSE(any(scene.tracer().occluded(splat(-1), away, kIncoherent)));
  });
}

TEST(Scene, EmissiveFacesBecomeLights) {
  SceneDescription description;
  add_shape(description, placed(make_rectangle(), Vec3(2, 0.5, 1), Vec3(0, 0, 3)), matte(0.0f), 7.0f);
  add_shape(description, make_cube(), matte(0.5f));
  const Scene scene(description);
  ASSERT_EQ(scene.lights().triangles().size(), 2u);
  double area = 0.0;
  for (const EmissiveTriangle& t : scene.lights().triangles()) {
    area += t.area;
    EXPECT_EQ(t.radiance[1], 7.0f);
    EXPECT_GT(t.normal.z(), 0.999f);
    EXPECT_EQ(scene.triangles()[t.triangle].light,
              static_cast<std::int32_t>(&t - scene.lights().triangles().data()));
  }
  EXPECT_NEAR(area, 4.0, 1e-6);
  const SurfacePoint16 p = scene.intersect(splat(-1), ray16(Vec3(0.3, 0.1, 9), Vec3(0, 0, -1)), kIncoherent);
  EXPECT_GE(p.light[0], 0);
  const SurfacePoint16 dark =
      scene.intersect(splat(-1), ray16(Vec3(0.3, 0.1, 2), Vec3(0, 0, -1)), kIncoherent);
  EXPECT_EQ(dark.light[0], -1);
}

TEST(Scene, MaterialSlotsMustExist) {
  SceneDescription description;
  add_shape(description, make_cube(), matte(0.5f));
  description.shapes[0].materials.clear();
  EXPECT_THROW(Scene{description}, std::logic_error);
}

}  // namespace
}  // namespace vrc
