// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/ellipse_tessellation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sample_meshes.h"

namespace vrc {
namespace {

const Vec3 kCentre(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0);

double area_of(const EllipseTessellation& t) {
  double sum = 0.0;
  for (const auto& [a, b, c] : t.triangles) {
    const Vec3 normal = (t.positions[b] - t.positions[a]).cross(t.positions[c] - t.positions[a]);
    EXPECT_GE(normal.dot(t.normals[a]), 0.0);
    sum += 0.5 * normal.norm();
  }
  return sum;
}

double length_of(const std::vector<OutlineSegment>& outline) {
  double sum = 0.0;
  for (const OutlineSegment& s : outline) sum += (s.end - s.begin).norm();
  return sum;
}

double polygon_area(const Vec2& radii, int segments) {
  return 0.5 * segments * std::sin(2.0 * kPi / segments) * radii.prod();
}

double polygon_length(const Vec2& radii, int segments) {
  double sum = 0.0;
  for (int i = 0; i < segments; ++i) {
    const double a = 2.0 * kPi * i / segments, b = 2.0 * kPi * (i + 1) / segments;
    sum += std::hypot(radii.x() * (std::cos(b) - std::cos(a)), radii.y() * (std::sin(b) - std::sin(a)));
  }
  return sum;
}

TEST(EllipseTessellation, OnAPlaneIsThePolygon) {
  const SurfaceMesh mesh =
      build_surface_mesh(test::make_height_field([](double, double) { return 0.0; }, 16, 0.8));
  const Vec2 radii(0.4, 0.15);
  EllipseTessellationOptions options;
  options.lift = 0.01;
  for (const double side : {1.0, -1.0}) {
    SurfaceEllipse ellipse = make_ellipse(mesh, 240, kCentre, Vec3(1, 2, 0), radii);
    ellipse.frame.normal *= side;
    ellipse.frame.bitangent *= side;
    const EllipseTessellation t = tessellate_ellipse(mesh, ellipse, options);
    EXPECT_NEAR(area_of(t), polygon_area(radii, 64), 1e-10);
    for (const Vec3& p : t.positions) EXPECT_NEAR(p.z(), side * 0.01, 1e-12);
    for (const Vec3& n : t.normals) EXPECT_NEAR(n.z(), side, 1e-12);

    const auto outline = ellipse_outline(mesh, ellipse);
    EXPECT_NEAR(length_of(outline), polygon_length(radii, 64), 1e-10);
    const auto p = mesh.positions(240);
    const Vec3 center = (p[0] + p[1] + p[2]) / 3.0;
    for (const OutlineSegment& s : outline) {
      const Vec3 d = s.begin - center;
      const double k =
          std::hypot(d.dot(ellipse.frame.tangent) / radii.x(), d.dot(ellipse.frame.bitangent) / radii.y());
      EXPECT_LE(k, 1.0 + 1e-12);
      EXPECT_GE(k, std::cos(kPi / 64) - 1e-12);
    }
  }
}

TEST(EllipseTessellation, EndsAtTheEdgesOfACube) {
  const SurfaceMesh cube = build_surface_mesh(make_cube());
  const double side_area = cube.face_area(0) + cube.face_area(1);
  const SurfaceEllipse large = make_ellipse(cube, 0, kCentre, Vec3(1, 2, 3), Vec2(50, 50));
  EXPECT_NEAR(area_of(tessellate_ellipse(cube, large)), side_area, 1e-9 * side_area);
  EXPECT_TRUE(ellipse_outline(cube, large).empty());
  // Half out of the side: the rim is open, and no point leaves the side.
  const double edge = std::sqrt(side_area);
  const SurfaceEllipse round =
      make_ellipse(cube, 0, Vec3(0.5, 0.25, 0.25), Vec3(1, 2, 3), 0.4 * edge * Vec2::Ones());
  const EllipseTessellation cut = tessellate_ellipse(cube, round);
  EXPECT_LT(area_of(cut), 0.99 * polygon_area(round.radii, 64));
  const auto outline = ellipse_outline(cube, round);
  EXPECT_GT(length_of(outline), 0.1 * edge);
  EXPECT_LT(length_of(outline), 0.99 * polygon_length(round.radii, 64));
  const auto p = cube.positions(0);
  for (const Vec3& x : cut.positions) EXPECT_NEAR((x - p[0]).dot(cube.face_normal(0)), 0.0, 1e-12);
}

TEST(EllipseTessellation, KeepsLengthsAndAreasAroundACylinder) {
  const double radius = 0.7;
  const SurfaceMesh mesh = build_surface_mesh(make_cylinder(Vec3(0, 0, -2), Vec3(0, 0, 2), radius, 96));
  std::uint32_t face = 0;
  const auto middle = [&](std::uint32_t f) {
    return (kCentre[0] * (mesh.positions(f)[0] + mesh.positions(f)[1] + mesh.positions(f)[2])).eval();
  };
  while (std::abs(mesh.face_normal(face).z()) > 0.1 || std::abs(middle(face).z()) > 1.0) ++face;
  const Vec2 radii(0.5, 0.3);
  const SurfaceEllipse ellipse = make_ellipse(mesh, face, kCentre, Vec3(0.3, -0.2, 1.0), radii);
  const auto outline = ellipse_outline(mesh, ellipse);
  EXPECT_NEAR(length_of(outline), polygon_length(radii, 64), 1e-9);
  EXPECT_NEAR(area_of(tessellate_ellipse(mesh, ellipse)), polygon_area(radii, 64), 1e-9);
  // Against the circumference of the ellipse itself [Ramanujan].
  const double a = radii.x(), b = radii.y();
  const double exact = kPi * (3.0 * (a + b) - std::sqrt((3.0 * a + b) * (a + 3.0 * b)));
  EXPECT_NEAR(length_of(outline), exact, 1e-3 * exact);
  for (const OutlineSegment& s : outline) {
    const double distance = std::hypot(s.begin.x(), s.begin.y());
    EXPECT_LE(distance, radius + 1e-12);
    EXPECT_GE(distance, radius * std::cos(kPi / 96) - 1e-12);
  }
}

TEST(EllipseTessellation, ReachesGeodesicDistancesOnASphere) {
  const double radius = 2.0, reach = 0.2;
  const SurfaceMesh mesh = build_surface_mesh(make_sphere(Vec3::Zero(), radius, 40));
  for (std::uint32_t f = 0; f < mesh.face_count(); f += 797) {
    const auto p = mesh.positions(f);
    const Vec3 center = (p[0] + p[1] + p[2]).normalized();
    const auto outline =
        ellipse_outline(mesh, make_ellipse(mesh, f, kCentre, Vec3(1, 2, 3), reach * Vec2::Ones()));
    EXPECT_NEAR(length_of(outline), 2.0 * kPi * radius * std::sin(reach / radius), 0.02 * reach);
    for (const OutlineSegment& s : outline) {
      const Vec3 n = s.begin.normalized();
      const double distance = radius * std::atan2(center.cross(n).norm(), center.dot(n));
      EXPECT_NEAR(distance, reach, 4e-3 * reach);
    }
  }
}

TEST(EllipseTessellation, RejectsTooFewSegmentsAndLeftHandedFrames) {
  const SurfaceMesh cube = build_surface_mesh(make_cube());
  SurfaceEllipse ellipse = make_ellipse(cube, 0, kCentre, Vec3(1, 2, 3), Vec2(1, 1));
  EllipseTessellationOptions options;
  options.segments = 2;
  EXPECT_THROW(static_cast<void>(tessellate_ellipse(cube, ellipse, options)), std::logic_error);
  ellipse.frame.bitangent *= -1.0;
  EXPECT_THROW(static_cast<void>(ellipse_outline(cube, ellipse)), std::logic_error);
}

}  // namespace
}  // namespace vrc
