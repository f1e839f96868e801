// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/creases.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/surface_mesh.h"
#include "sample_meshes.h"

namespace vrc {
namespace {

using test::make_soup;
using test::without_normals;

std::size_t count_creases(const SurfaceMesh& mesh, unsigned reason = 0xff) {
  std::size_t count = 0;
  for (const std::uint8_t bits : mesh.creases()) count += (bits & reason) != 0 ? 1 : 0;
  return count;
}

// Two triangles over a common edge on the y axis, bent by `degrees`.
PolygonSoup make_hinge(double degrees) {
  const double a = degrees * kPi / 180.0;
  return make_soup({{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {std::cos(a), 0, -std::sin(a)}},
                   {{0, 1, 2}, {1, 0, 3}});
}

// Gives each corner of the hinge a normal: the two of the common edge per face.
PolygonSoup with_hinge_normals(PolygonSoup soup, const Vec3& left, const Vec3& right) {
  soup.normals = {left.normalized(), right.normalized()};
  soup.corner_normal = {0, 0, 0, 1, 1, 1};
  return soup;
}

TEST(Creases, CubeHasTwelveAndSixRegions) {
  for (const PolygonSoup& cube : {make_cube(), without_normals(make_cube())}) {
    const SurfaceMesh mesh = build_surface_mesh(cube);
    EXPECT_EQ(count_creases(mesh), 12u);
    EXPECT_EQ(count_creases(mesh, kCreaseAngle), 12u);
    EXPECT_EQ(mesh.region_count(), 6u);
    EXPECT_EQ(mesh.sector_count(), 24u);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      EXPECT_EQ(mesh.region(f), mesh.source_polygon(f));
      for (int k = 0; k < 3; ++k) EXPECT_LT((mesh.corner_normal(f, k) - mesh.face_normal(f)).norm(), 1e-15);
    }
  }
}

TEST(Creases, SphereIsOneRegion) {
  const SurfaceMesh exact = build_surface_mesh(make_sphere(Vec3::Zero(), 1.0, 12));
  EXPECT_EQ(exact.region_count(), 1u);
  EXPECT_EQ(count_creases(exact), 0u);
  EXPECT_EQ(exact.sector_count(), exact.vertex_count());
  const SurfaceMesh averaged = build_surface_mesh(without_normals(make_sphere(Vec3::Zero(), 1.0, 12)));
  EXPECT_EQ(averaged.region_count(), 1u);
  for (std::size_t f = 0; f < exact.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 outward = exact.positions(f)[static_cast<std::size_t>(k)].normalized();
      EXPECT_LT((exact.corner_normal(f, k) - outward).norm(), 1e-12);
      EXPECT_LT((averaged.corner_normal(f, k) - outward).norm(), 0.02);
    }
  }
}

TEST(Creases, SuppliedNormalsKeepACoarseSphereSmooth) {
  const PolygonSoup coarse = make_sphere(Vec3::Zero(), 1.0, 1);  // a cube with the normals of a sphere
  const SurfaceMesh exact = build_surface_mesh(coarse, {.creases = {.smooth_normals_angle = 91.0}});
  EXPECT_EQ(exact.region_count(), 1u);
  EXPECT_EQ(exact.sector_count(), 8u);
  EXPECT_EQ(build_surface_mesh(without_normals(coarse)).region_count(), 6u);
}

TEST(Creases, OpenCylinderIsOneRegionWithTwoRims) {
  const PolygonSoup cylinder = make_cylinder(Vec3::Zero(), Vec3(0, 0, 2), 1.0, 40);
  for (const PolygonSoup& soup : {cylinder, without_normals(cylinder)}) {
    const SurfaceMesh mesh = build_surface_mesh(soup);
    EXPECT_EQ(mesh.region_count(), 1u);
    EXPECT_EQ(count_creases(mesh), 80u);
    EXPECT_EQ(count_creases(mesh, kCreaseBoundary), 80u);
  }
}

TEST(Creases, AngleDecidesWithoutNormals) {
  EXPECT_EQ(build_surface_mesh(make_hinge(39.0)).region_count(), 1u);
  EXPECT_EQ(build_surface_mesh(make_hinge(41.0)).region_count(), 2u);
  EXPECT_EQ(build_surface_mesh(make_hinge(-41.0)).region_count(), 2u);
  EXPECT_EQ(build_surface_mesh(make_hinge(41.0), {.creases = {.crease_angle = 45.0}}).region_count(), 1u);
}

TEST(Creases, SplitNormalsMakeACreaseOnAFlatEdge) {
  const Vec3 up = Vec3::UnitZ();
  const auto regions = [&](double degrees, double split) {
    const Vec3 turned(std::sin(split * kPi / 180.0), 0.0, std::cos(split * kPi / 180.0));
    return build_surface_mesh(with_hinge_normals(make_hinge(degrees), up, turned)).region_count();
  };
  EXPECT_EQ(regions(0.0, 0.0), 1u);
  EXPECT_EQ(regions(0.0, 0.5), 1u);
  EXPECT_EQ(regions(0.0, 2.0), 2u);
  EXPECT_EQ(regions(60.0, 0.0), 1u) << "agreeing normals smooth a sharp edge";
  EXPECT_EQ(regions(95.0, 0.0), 2u) << "but not beyond a right angle";
}

TEST(Creases, SplitAtOneEndIsEnough) {
  PolygonSoup soup = with_hinge_normals(make_hinge(0.0), Vec3(0, 0, 1), Vec3(0.2, 0, 1));
  soup.corner_normal = {0, 0, 0, 0, 1, 1};
  EXPECT_EQ(build_surface_mesh(soup).region_count(), 2u);
}

TEST(Creases, WhereACornerLacksItsNormalTheAngleDecides) {
  PolygonSoup soup = with_hinge_normals(make_hinge(60.0), Vec3(0, 0, 1), Vec3(0, 0, 1));
  soup.corner_normal[0] = kInvalidIndex;
  EXPECT_EQ(build_surface_mesh(soup).region_count(), 2u);
}

TEST(Creases, MaterialBorders) {
  PolygonSoup soup = make_hinge(0.0);
  soup.face_material = {4, 7};
  const SurfaceMesh mesh = build_surface_mesh(soup);
  EXPECT_EQ(mesh.region_count(), 2u);
  EXPECT_EQ(count_creases(mesh, kCreaseMaterial), 1u);
  EXPECT_EQ(mesh.material(0), 4u);
  EXPECT_EQ(mesh.material(1), 7u);
}

TEST(Creases, NonManifoldEdgesAreMarkedOnEverySide) {
  PolygonSoup soup = test::make_tetrahedron();
  soup.positions.push_back({3, 0, 1});
  soup.add_face(std::vector<std::uint32_t>{0, 1, 4});
  const SurfaceMesh mesh = build_surface_mesh(soup, {.creases = {.crease_angle = 180.0}});
  EXPECT_EQ(count_creases(mesh, kCreaseNonManifold), 2u);  // the closed body's edge and the fin's
  EXPECT_EQ(count_creases(mesh, kCreaseBoundary), 3u);
  EXPECT_EQ(mesh.region_count(), 2u);
}

TEST(Creases, FlatShadingSeparatesEveryBend) {
  const SurfaceMesh sphere = build_surface_mesh(make_sphere(Vec3::Zero(), 1.0, 4), {.face_normals = true});
  for (std::size_t f = 0; f < sphere.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((sphere.corner_normal(f, k) - sphere.face_normal(f)).norm(), 2e-3);
      EXPECT_FALSE(sphere.normal_is_supplied(sphere.corner_sector(f, k)));
    }
  }
  EXPECT_GE(sphere.region_count(), 96u);
  EXPECT_EQ(build_surface_mesh(make_cube(), {.face_normals = true}).region_count(), 6u);
  EXPECT_EQ(build_surface_mesh(make_rectangle(), {.face_normals = true}).region_count(), 1u);
}

TEST(Creases, MissingNormalsAreTheAngleWeightedMean) {
  // Around the tip of a pyramid on a square base the angles are equal: the mean points up, however
  // unevenly a side is cut into triangles.
  const PolygonSoup soup =
      make_soup({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0, 0, 0.5}, {0.8, 1, 0}},
                {{4, 0, 5}, {4, 5, 1}, {4, 1, 2}, {4, 2, 3}, {4, 3, 0}});
  const SurfaceMesh mesh = build_surface_mesh(soup, {.creases = {.crease_angle = 60.0}});
  EXPECT_LT((mesh.corner_normal(0, 0) - Vec3::UnitZ()).norm(), 1e-14);
}

}  // namespace
}  // namespace vrc
