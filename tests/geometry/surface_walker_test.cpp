// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_walker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "sample_meshes.h"
#include "support.h"

namespace vrc {
namespace {

using test::make_soup;
using test::without_normals;

const Vec3 kCentre(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0);

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Vec3 point_on(const SurfaceMesh& mesh, std::size_t face, const Vec3& b) {
  const auto p = mesh.positions(face);
  return b[0] * p[0] + b[1] * p[1] + b[2] * p[2];
}

std::set<std::uint32_t> reached(const SurfaceWalk& walk) {
  std::set<std::uint32_t> faces;
  for (const WalkedFace& f : walk.faces) EXPECT_TRUE(faces.insert(f.face).second) << f.face << " twice";
  return faces;
}

// Slow and obvious: the origin is inside, or an edge passes close enough.
bool triangle_meets_unit_disk(const std::array<Vec2, 3>& p) {
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2& a = p[k];
    const Vec2 d = p[(k + 1) % 3] - a;
    inside = inside && cross(d, -a) >= 0.0;
    for (int i = 0; i <= 2000; ++i) {
      if ((a + i / 2000.0 * d).squaredNorm() <= 1.0) return true;
    }
  }
  return inside;
}

SurfaceMesh plane(int n) {
  return build_surface_mesh(test::make_height_field([](double, double) { return 0.0; }, n, 0.8));
}

// Faces that share smooth edges with the given one, and so on.
bool same_region(const SurfaceMesh& mesh, const SurfaceWalk& walk) {
  return std::all_of(walk.faces.begin(), walk.faces.end(), [&](const WalkedFace& f) {
    return mesh.region(f.face) == mesh.region(walk.faces.front().face);
  });
}

TEST(SurfaceWalk, OnAPlaneReachesExactlyTheFacesThatMeetTheEllipse) {
  const SurfaceMesh mesh = plane(16);
  test::SeededBits random(4);
  for (int i = 0; i < 30; ++i) {
    const auto face = static_cast<std::uint32_t>(random.below(mesh.face_count()));
    const double angle = 2.0 * kPi * random.uniform();
    const Vec2 radii(0.02 + 0.5 * random.uniform(), 0.02 + 0.5 * random.uniform());
    const SurfaceEllipse ellipse =
        make_ellipse(mesh, face, kCentre, Vec3(std::cos(angle), std::sin(angle), 0.3), radii);
    const SurfaceWalk walk = walk_surface(mesh, ellipse);
    EXPECT_EQ(walk.faces.front().face, face);
    EXPECT_FALSE(walk.truncated);
    EXPECT_LT(walk.normal_deviation, 1e-7);
    const std::set<std::uint32_t> faces = reached(walk);
    const Vec3 center = point_on(mesh, face, kCentre);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      std::array<Vec2, 3> shrunk;
      std::array<Vec2, 3> grown;
      const auto p = mesh.positions(f);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 d = p[k] - center;
        const Vec2 q(d.dot(ellipse.frame.tangent) / radii.x(), d.dot(ellipse.frame.bitangent) / radii.y());
        shrunk[k] = q / 1.003;  // The brute force samples edges.
        grown[k] = q / (1.0 - 1e-9);
      }
      if (faces.count(f) != 0) {
        EXPECT_TRUE(triangle_meets_unit_disk(shrunk)) << "face " << f;
      } else {
        EXPECT_FALSE(triangle_meets_unit_disk(grown)) << "face " << f;
      }
    }
    for (const WalkedFace& walked : walk.faces) {
      const auto q = mesh.positions(walked.face);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 d = q[k] - center;
        EXPECT_LT(
            (walked.corners[k] - Vec2(d.dot(ellipse.frame.tangent), d.dot(ellipse.frame.bitangent))).norm(),
            1e-12);
      }
    }
  }
}

TEST(SurfaceWalk, KeepsLengthsAndOrientation) {
  const SurfaceMesh mesh = build_surface_mesh(test::make_torus(2.0, 0.6, 32, 24, 0.5));
  for (const double side : {1.0, -1.0}) {
    SurfaceEllipse ellipse = make_ellipse(mesh, 77, kCentre, Vec3(1, 2, 3), Vec2(0.9, 0.5));
    ellipse.frame.normal *= side;
    ellipse.frame.bitangent *= side;
    const SurfaceWalk walk = walk_surface(mesh, ellipse);
    EXPECT_GT(walk.faces.size(), 50u);
    for (const WalkedFace& walked : walk.faces) {
      const auto p = mesh.positions(walked.face);
      for (std::size_t k = 0; k < 3; ++k) {
        const double length = (p[(k + 1) % 3] - p[k]).norm();
        EXPECT_NEAR((walked.corners[(k + 1) % 3] - walked.corners[k]).norm(), length, 1e-9 * length);
      }
      const double area =
          0.5 * cross(walked.corners[1] - walked.corners[0], walked.corners[2] - walked.corners[0]);
      EXPECT_NEAR(area, side * mesh.face_area(walked.face), 1e-9);
    }
  }
}

TEST(SurfaceWalk, BothSidesOfASurfaceReachTheSameFaces) {
  const SurfaceMesh mesh = build_surface_mesh(test::make_torus(2.0, 0.6, 32, 24, 0.5));
  SurfaceEllipse ellipse = make_ellipse(mesh, 5, kCentre, Vec3(1, 2, 3), Vec2(0.9, 0.5));
  const SurfaceWalk front = walk_surface(mesh, ellipse);
  ellipse.frame.normal *= -1.0;
  ellipse.frame.bitangent *= -1.0;
  const SurfaceWalk back = walk_surface(mesh, ellipse);
  EXPECT_EQ(reached(front), reached(back));
  EXPECT_NEAR(front.normal_deviation, back.normal_deviation, 1e-9);
}

TEST(SurfaceWalk, StopsAtTheEdgesOfACube) {
  const SurfaceMesh cube = build_surface_mesh(make_cube());
  for (std::uint32_t f = 0; f < cube.face_count(); ++f) {
    const SurfaceWalk walk = walk_surface(cube, make_ellipse(cube, f, kCentre, Vec3(1, 2, 3), Vec2(50, 50)));
    EXPECT_EQ(reached(walk).size(), 2u);
    EXPECT_TRUE(same_region(cube, walk));
    EXPECT_LT(walk.normal_deviation, 1e-7);
  }
}

TEST(SurfaceWalk, DoesNotLeakBetweenSheets) {
  const auto sheet = [](double, double) { return 0.0; };
  PolygonSoup soup = test::make_height_field(sheet, 12);
  const auto faces = static_cast<std::uint32_t>(2 * soup.face_count());
  test::append(soup, test::make_height_field(sheet, 12), Vec3(0, 0, 1e-3));
  const SurfaceMesh mesh = build_surface_mesh(soup);
  const SurfaceWalk walk = walk_surface(mesh, make_ellipse(mesh, 100, kCentre, Vec3::UnitX(), Vec2(5, 5)));
  EXPECT_EQ(walk.faces.size(), faces);
  for (const WalkedFace& f : walk.faces) EXPECT_LT(f.face, faces);
}

TEST(SurfaceWalk, StaysOnOneStepOfAStair) {
  std::vector<Vec3> positions;
  test::FaceList faces;
  constexpr std::uint32_t kSteps = 10;
  for (std::uint32_t i = 0; i <= 2 * kSteps; ++i) {
    for (const double y : {0.0, 1.0}) positions.emplace_back(0.05 * ((i + 1) / 2), y, 0.05 * (i / 2));
    if (i > 0) faces.push_back({2 * i - 2, 2 * i, 2 * i + 1, 2 * i - 1});
  }
  const SurfaceMesh mesh = build_surface_mesh(make_soup(positions, faces));
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const SurfaceWalk walk =
        walk_surface(mesh, make_ellipse(mesh, f, kCentre, Vec3(1, 1, 1), Vec2(1.0, 0.5)));
    EXPECT_EQ(reached(walk).size(), 2u);
    EXPECT_EQ(mesh.source_polygon(walk.faces[0].face), mesh.source_polygon(walk.faces[1].face));
  }
}

TEST(SurfaceWalk, UnfoldsASphereToGeodesicDistances) {
  const double radius = 2.0;
  const SurfaceMesh mesh = build_surface_mesh(make_sphere(Vec3::Zero(), radius, 96));
  double worst = 0.0;
  for (std::uint32_t f = 0; f < mesh.face_count(); f += 997) {
    const Vec3 center = point_on(mesh, f, kCentre).normalized();
    const double reach = 0.1 * radius;  // k s = 0.1
    const SurfaceWalk walk =
        walk_surface(mesh, make_ellipse(mesh, f, kCentre, Vec3(1, 2, 3), Vec2(reach, reach)));
    double furthest = 0.0;
    for (const WalkedFace& walked : walk.faces) {
      const auto p = mesh.positions(walked.face);
      for (std::size_t k = 0; k < 3; ++k) {
        const double s =
            radius * std::atan2(center.cross(p[k].normalized()).norm(), center.dot(p[k].normalized()));
        if (s < 0.3 * reach || s > reach) continue;
        worst = std::max(worst, std::abs(walked.corners[k].norm() - s) / s);
        furthest = std::max(furthest, s);
      }
    }
    EXPECT_GT(furthest, 0.9 * reach);
    EXPECT_NEAR(walk.normal_deviation, 0.1, 0.002);
  }
  EXPECT_LT(worst, 1.5e-3) << "relative to the geodesic distance";
}

TEST(SurfaceWalk, UnrollsACylinderExactly) {
  constexpr int kSegments = 40;
  const SurfaceMesh mesh = build_surface_mesh(make_cylinder(Vec3::Zero(), Vec3(0, 0, 4), 1.0, kSegments));
  // Round the prism, a segment is as long as its chord.
  const double turn = 2.0 * kSegments * std::sin(kPi / kSegments);
  const SurfaceEllipse ellipse = make_ellipse(mesh, 7, kCentre, Vec3::UnitZ(), Vec2(0.5, 0.4 * turn));
  const SurfaceWalk walk = walk_surface(mesh, ellipse);
  const Vec3 center = point_on(mesh, 7, kCentre);
  for (const WalkedFace& walked : walk.faces) {
    const auto p = mesh.positions(walked.face);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(walked.corners[k].dot(Vec2(1, 0)), p[k].z() - center.z(), 1e-9);
    }
    EXPECT_LT(walked.corners[0].cwiseAbs().y(), turn);
  }
}

TEST(SurfaceWalk, WrapsAroundACylinderOnce) {
  constexpr int kSegments = 40;
  const SurfaceMesh mesh = build_surface_mesh(make_cylinder(Vec3::Zero(), Vec3(0, 0, 4), 1.0, kSegments));
  const SurfaceWalk walk = walk_surface(mesh, make_ellipse(mesh, 7, kCentre, Vec3::UnitZ(), Vec2(9, 9)));
  EXPECT_EQ(reached(walk).size(), mesh.face_count());
  EXPECT_GT(walk.normal_deviation, 0.95 * kPi);
  double furthest = 0.0;
  for (const WalkedFace& walked : walk.faces) furthest = std::max(furthest, std::abs(walked.corners[0].y()));
  EXPECT_LT(furthest, 1.2 * kPi) << "the back is reached from both sides";
}

TEST(SurfaceWalk, MeasuresDeviationInsideTheEllipseOnly) {
  // One coarse face with exact normals: a small ellipse sees a small part of how they turn.
  const SurfaceMesh mesh = build_surface_mesh(make_cylinder(Vec3::Zero(), Vec3(0, 0, 1), 1.0, 8));
  double previous = 0.0;
  for (const double r : {0.001, 0.01, 0.05, 0.1}) {
    const SurfaceWalk walk = walk_surface(mesh, make_ellipse(mesh, 3, kCentre, Vec3::UnitZ(), Vec2(r, r)));
    EXPECT_NEAR(walk.normal_deviation, r, 0.25 * r);
    EXPECT_GT(walk.normal_deviation, previous);
    previous = walk.normal_deviation;
  }
}

TEST(SurfaceWalk, DoesNotEnterFacesThatTurnAway) {
  const SurfaceMesh mesh = build_surface_mesh(make_sphere(Vec3::Zero(), 1.0, 32));
  const SurfaceEllipse ellipse =
      make_ellipse(mesh, 700, Vec3(0.3, 0.3, 0.4), Vec3(0.3, 0.5, 0.1), Vec2(1.0, 0.8));
  SurfaceWalkOptions options;
  options.max_deviation = 0.3;
  const SurfaceWalk all = walk_surface(mesh, ellipse), some = walk_surface(mesh, ellipse, options);
  EXPECT_LT(some.faces.size(), all.faces.size() / 2);
  std::set<std::uint32_t> entered;
  for (const WalkedFace& f : some.faces) entered.insert(f.face);
  for (const WalkedFace& f : all.faces) {
    double least = kPi;
    for (int k = 0; k < 3; ++k)
      least = std::min(least, std::acos(mesh.corner_normal(f.face, k).dot(ellipse.frame.normal)));
    if (least <= 0.3) {
      EXPECT_TRUE(entered.contains(f.face)) << least;
    }
    // A face of this mesh spans about 0.05.
    if (least > 0.4) {
      EXPECT_FALSE(entered.contains(f.face)) << least;
    }
  }
  options.measure_deviation = false;
  EXPECT_EQ(walk_surface(mesh, ellipse, options).normal_deviation, 0.0);
  EXPECT_EQ(walk_surface(mesh, ellipse, options).faces.size(), some.faces.size());
}

TEST(SurfaceWalk, KeepsTheNearestFacesWhenTruncated) {
  const SurfaceMesh mesh = plane(24);
  const SurfaceEllipse ellipse = make_ellipse(mesh, 500, kCentre, Vec3::UnitX(), Vec2(0.4, 0.4));
  const SurfaceWalk all = walk_surface(mesh, ellipse);
  const SurfaceWalk few = walk_surface(mesh, ellipse, {.max_faces = 10});
  EXPECT_TRUE(few.truncated);
  ASSERT_EQ(few.faces.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(few.faces[i].face, all.faces[i].face);
  EXPECT_FALSE(walk_surface(mesh, ellipse, {.max_faces = all.faces.size()}).truncated);
}

TEST(SurfaceWalk, IsSoundOnEverySample) {
  test::SeededBits random(8);
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    const SurfaceMesh mesh = build_surface_mesh(without_normals(soup));
    for (int i = 0; i < 20; ++i) {
      const auto face = static_cast<std::uint32_t>(random.below(mesh.face_count()));
      const Vec2 radii(0.1 + random.uniform(), 0.1 + random.uniform());
      const SurfaceEllipse ellipse = make_ellipse(mesh, face, kCentre, Vec3(1.0, 2.0, 3.1), radii);
      const SurfaceWalk walk = walk_surface(mesh, ellipse);
      EXPECT_TRUE(same_region(mesh, walk));
      EXPECT_EQ(reached(walk).size(), walk.faces.size());
      const SurfaceWalk again = walk_surface(mesh, ellipse);
      ASSERT_EQ(again.faces.size(), walk.faces.size());
      for (std::size_t f = 0; f < walk.faces.size(); ++f) EXPECT_EQ(again.faces[f].face, walk.faces[f].face);
    }
  }
}

TEST(SurfaceWalk, RefusesBrokenEllipses) {
  const SurfaceMesh cube = build_surface_mesh(make_cube());
  const SurfaceEllipse good = make_ellipse(cube, 0, kCentre, Vec3(1, 2, 3), Vec2(1, 1));
  SurfaceEllipse bad = good;
  bad.face = 12;
  EXPECT_THROW((void)walk_surface(cube, bad), std::logic_error);
  bad = good;
  bad.radii.x() = 0.0;
  EXPECT_THROW((void)walk_surface(cube, bad), std::logic_error);
  EXPECT_THROW((void)make_ellipse(cube, 0, kCentre, Vec3::Zero(), Vec2(1, 1)), std::logic_error);
}

TEST(MeetsEllipse, IsClosedAndFollowsTheAxes) {
  const Vec2 radii(2.0, 1.0);
  EXPECT_TRUE(meets_ellipse(Vec2(2, -1), Vec2(2, 1), radii));
  EXPECT_FALSE(meets_ellipse(Vec2(2.01, -1), Vec2(2.01, 1), radii));
  EXPECT_TRUE(meets_ellipse(Vec2(-9, 0.9), Vec2(9, 0.9), radii));
  EXPECT_FALSE(meets_ellipse(Vec2(-9, 1.1), Vec2(9, 1.1), radii));
  EXPECT_TRUE(meets_ellipse(Vec2(0.1, 0.1), Vec2(0.1, 0.1), radii));
  EXPECT_FALSE(meets_ellipse(Vec2(1.8, 0.9), Vec2(5.0, 5.0), radii));
}

}  // namespace
}  // namespace vrc
