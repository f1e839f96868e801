// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace vrc {
namespace {

// Half-edges by (from, to): each must be used once for a consistently oriented manifold.
using HalfEdges = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

HalfEdges half_edges(const PolygonSoup& soup) {
  HalfEdges edges;
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    const auto corners = soup.face_positions(face);
    for (std::size_t i = 0; i < corners.size(); ++i) ++edges[{corners[i], corners[(i + 1) % corners.size()]}];
  }
  return edges;
}

std::size_t boundary_edges(const HalfEdges& edges) {
  return static_cast<std::size_t>(std::count_if(edges.begin(), edges.end(), [&](const auto& edge) {
    return !edges.contains({edge.first.second, edge.first.first});
  }));
}

bool is_oriented_manifold(const HalfEdges& edges) {
  return std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 1; });
}

// V - E + F.
std::ptrdiff_t euler_characteristic(const PolygonSoup& soup) {
  const HalfEdges edges = half_edges(soup);
  const std::size_t edge_count = (edges.size() + boundary_edges(edges)) / 2;
  return static_cast<std::ptrdiff_t>(soup.positions.size() + soup.face_count()) -
         static_cast<std::ptrdiff_t>(edge_count);
}

Vec3 area_vector(const PolygonSoup& soup, std::size_t face) {
  const auto corners = soup.face_positions(face);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 first = soup.positions[corners[0]];
    sum += 0.5 * (soup.positions[corners[i]] - first).cross(soup.positions[corners[i + 1]] - first);
  }
  return sum;
}

double total_area(const PolygonSoup& soup) {
  double area = 0.0;
  for (std::size_t face = 0; face < soup.face_count(); ++face) area += area_vector(soup, face).norm();
  return area;
}

// The enclosed volume, as the sum of the tetrahedra from the origin to the fans of the faces.
double volume(const PolygonSoup& soup) {
  double sum = 0.0;
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    sum += soup.positions[soup.face_positions(face)[0]].dot(area_vector(soup, face)) / 3.0;
  }
  return sum;
}

// Every corner has a normal, and it agrees with the side that the corner order names.
void expect_normals_agree(const PolygonSoup& soup, double least_cosine) {
  ASSERT_EQ(soup.corner_normal.size(), soup.corner_position.size()) << soup.source;
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    const Vec3 geometric = area_vector(soup, face).normalized();
    for (std::size_t corner = soup.face_begin[face]; corner < soup.face_begin[face + 1]; ++corner) {
      ASSERT_GE(soup.normals[soup.corner_normal[corner]].dot(geometric), least_cosine)
          << soup.source << " face " << face;
    }
  }
}

TEST(Shapes, AllAreValidAndConsistentlyOriented) {
  for (const PolygonSoup& soup :
       {make_rectangle(), make_cube(), make_disk(), make_cylinder(Vec3(0, 0, 0), Vec3(1, 2, 3), 0.5),
        make_sphere(Vec3::Zero(), 1)}) {
    EXPECT_NO_THROW(soup.validate());
    EXPECT_TRUE(is_oriented_manifold(half_edges(soup))) << soup.source;
    expect_normals_agree(soup, 0.999);
    for (const Vec2& uv : soup.uvs) {
      EXPECT_TRUE((uv.array() >= 0.0).all() && (uv.array() <= 1.0).all()) << soup.source;
    }
  }
}

TEST(Shapes, Rectangle) {
  const PolygonSoup soup = make_rectangle();
  EXPECT_DOUBLE_EQ(total_area(soup), 4.0);
  EXPECT_EQ(area_vector(soup, 0).normalized(), Vec3::UnitZ());
  EXPECT_EQ(euler_characteristic(soup), 1);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const Vec3& p = soup.positions[soup.corner_position[corner]];
    EXPECT_EQ(soup.uvs[soup.corner_uv[corner]], Vec2((p.head<2>() + Vec2::Ones()) / 2));
  }
}

TEST(Shapes, CubeIsClosed) {
  const PolygonSoup soup = make_cube();
  EXPECT_EQ(soup.positions.size(), 8u);
  EXPECT_EQ(soup.face_count(), 6u);
  EXPECT_EQ(boundary_edges(half_edges(soup)), 0u);
  EXPECT_EQ(euler_characteristic(soup), 2);
  EXPECT_DOUBLE_EQ(total_area(soup), 24.0);
  EXPECT_DOUBLE_EQ(volume(soup), 8.0);  // Positive: the faces look out.
  EXPECT_EQ(soup.bounds().min(), Vec3(-1, -1, -1));
  EXPECT_EQ(soup.bounds().max(), Vec3(1, 1, 1));
}

TEST(Shapes, DiskHasOneBoundaryAndItsArea) {
  const int n = 64;
  const PolygonSoup soup = make_disk(n);
  EXPECT_EQ(euler_characteristic(soup), 1);
  EXPECT_EQ(boundary_edges(half_edges(soup)), 64u);
  EXPECT_NEAR(total_area(soup), n / 2.0 * std::sin(2.0 * kPi / n), 1e-12);
  expect_normals_agree(soup, 1.0 - 1e-12);
  for (std::size_t corner = 0; corner < soup.corner_position.size(); ++corner) {
    const Vec3& p = soup.positions[soup.corner_position[corner]];
    EXPECT_NEAR(soup.uvs[soup.corner_uv[corner]][0], p.norm(), 1e-12);
  }
}

TEST(Shapes, CylinderIsAWeldedTubeWithRadialNormals) {
  const Vec3 p0(1, 2, 3);
  const Vec3 p1(4, 0, 7);
  const double radius = 0.75;
  const int n = 96;
  const PolygonSoup soup = make_cylinder(p0, p1, radius, n);
  const double length = (p1 - p0).norm();
  const Vec3 axis = (p1 - p0) / length;
  EXPECT_EQ(soup.positions.size(), 192u);
  EXPECT_EQ(euler_characteristic(soup), 0);
  EXPECT_EQ(boundary_edges(half_edges(soup)), 192u);  // Two open ends and no seam.
  EXPECT_NEAR(total_area(soup), 2.0 * n * std::sin(kPi / n) * radius * length, 1e-10);
  for (std::size_t corner = 0; corner < soup.corner_position.size(); ++corner) {
    const Vec3 from_start = soup.positions[soup.corner_position[corner]] - p0;
    const double height = from_start.dot(axis);
    const Vec3 radial = from_start - height * axis;
    EXPECT_NEAR(radial.norm(), radius, 1e-12);
    EXPECT_TRUE(soup.normals[soup.corner_normal[corner]].isApprox(radial / radius, 1e-12));
    EXPECT_NEAR(soup.uvs[soup.corner_uv[corner]][1], height / length, 1e-12);
  }
  for (std::size_t face = 0; face < soup.face_count(); ++face) {  // No face spans the seam backwards.
    const double u0 = soup.uvs[soup.corner_uv[soup.face_begin[face]]][0];
    const double u1 = soup.uvs[soup.corner_uv[soup.face_begin[face] + 1]][0];
    EXPECT_NEAR(u1 - u0, 1.0 / n, 1e-12);
  }
}

TEST(Shapes, SphereIsWeldedAndExact) {
  const Vec3 center(3, -2, 5);
  const double radius = 2.5;
  for (const int n : {1, 2, 3, 8}) {
    const PolygonSoup soup = make_sphere(center, radius, n);
    EXPECT_NO_THROW(soup.validate());
    EXPECT_EQ(soup.positions.size(), static_cast<std::size_t>(6 * n * n + 2));
    EXPECT_EQ(soup.face_count(), static_cast<std::size_t>(6 * n * n));
    EXPECT_TRUE(is_oriented_manifold(half_edges(soup)));
    EXPECT_EQ(boundary_edges(half_edges(soup)), 0u);
    EXPECT_EQ(euler_characteristic(soup), 2);
    EXPECT_GT(volume(soup), 0.0);
    for (std::size_t i = 0; i < soup.positions.size(); ++i) {
      EXPECT_NEAR(soup.normals[i].norm(), 1.0, 1e-14);
      EXPECT_TRUE(soup.positions[i].isApprox(center + radius * soup.normals[i], 1e-14));
    }
    EXPECT_EQ(soup.corner_normal, soup.corner_position);
  }
}

TEST(Shapes, SphereAreaConvergesAndQuadsAreEven) {
  const auto area_error = [](int n) {
    return 1.0 - total_area(make_sphere(Vec3::Zero(), 1.0, n)) / (4.0 * kPi);
  };
  EXPECT_LT(area_error(48), 1e-3);
  EXPECT_NEAR(area_error(24) / area_error(48), 4.0, 0.1);  // Second order.
  const PolygonSoup soup = make_sphere(Vec3::Zero(), 1.0, 48);
  double smallest = 1.0;
  double largest = 0.0;
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    smallest = std::min(smallest, area_vector(soup, face).norm());
    largest = std::max(largest, area_vector(soup, face).norm());
  }
  EXPECT_LT(largest / smallest, 1.5);
}

TEST(Shapes, RefuseImpossibleSizes) {
  EXPECT_THROW(make_sphere(Vec3::Zero(), 0.0), InputError);
  EXPECT_THROW(make_sphere(Vec3::Zero(), std::nan("")), InputError);
  EXPECT_THROW(make_sphere(Vec3(std::nan(""), 0, 0), 1.0), InputError);
  EXPECT_THROW(make_cylinder(Vec3::Zero(), Vec3::UnitZ(), -1.0), InputError);
  EXPECT_THROW(make_cylinder(Vec3::UnitZ(), Vec3::UnitZ(), 1.0), InputError);
}

}  // namespace
}  // namespace vrc
