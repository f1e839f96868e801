// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_mesh.h"

#include <gtest/gtest.h>

#include <map>

#include "core/error.h"
#include "sample_meshes.h"
#include "support.h"

namespace vrc {
namespace {

struct Topology {
  std::size_t components;
  std::size_t boundary_loops;
  std::size_t genus;
};

const std::map<std::string, Topology>& expected_topology() {
  static const std::map<std::string, Topology> topology = {
      {"rectangle", {1, 1, 0}},     {"cube", {1, 0, 0}},          {"disk", {1, 1, 0}},
      {"cylinder", {1, 2, 0}},      {"sphere", {1, 0, 0}},        {"torus", {1, 0, 1}},
      {"height field", {1, 1, 0}},  {"moebius strip", {1, 1, 0}}, {"tetrahedron", {1, 0, 0}},
      {"two tetrahedra", {2, 0, 0}}};
  return topology;
}

TEST(SurfaceMesh, EulerCharacteristic) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    const SurfaceMesh mesh = build_surface_mesh(soup);
    const MeshReport& report = mesh.report();
    const Topology& topology = expected_topology().at(name);
    EXPECT_EQ(report.components, topology.components);
    EXPECT_EQ(report.boundary_loops, topology.boundary_loops);
    EXPECT_EQ(report.genus, topology.genus);
    EXPECT_EQ(report.watertight, topology.boundary_loops == 0);
    EXPECT_EQ(report.vertices, mesh.vertex_count());
    EXPECT_EQ(report.edges, mesh.edge_count());
    EXPECT_EQ(report.faces, mesh.face_count());
  }
}

TEST(SurfaceMesh, CornersEdgesAndNeighboursAgreeWithTheHalfedges) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    const SurfaceMesh mesh = build_surface_mesh(soup);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const OpenMesh::HalfedgeHandle h = face_halfedge(mesh.mesh(), f, k);
        const auto next = static_cast<std::size_t>((k + 1) % 3);
        EXPECT_EQ(mesh.mesh().from_vertex_handle(h).idx(),
                  static_cast<int>(mesh.triangle(f)[static_cast<std::size_t>(k)]));
        EXPECT_EQ(mesh.mesh().to_vertex_handle(h).idx(), static_cast<int>(mesh.triangle(f)[next]));
        EXPECT_EQ(halfedge_corner(mesh.mesh(), h), k);
        const std::uint32_t g = mesh.neighbour(f, k);
        if (g == kInvalidIndex) {
          EXPECT_NE(mesh.crease(mesh.edge(f, k)) & kCreaseBoundary, 0);
          continue;
        }
        const int across = halfedge_corner(mesh.mesh(), mesh.mesh().opposite_halfedge_handle(h));
        EXPECT_EQ(mesh.neighbour(g, across), f);
        EXPECT_EQ(mesh.edge(g, across), mesh.edge(f, k));
        if (mesh.crease(mesh.edge(f, k)) == 0) {
          EXPECT_EQ(mesh.region(g), mesh.region(f));
          EXPECT_EQ(mesh.corner_sector(f, k), mesh.corner_sector(g, (across + 1) % 3));
        }
      }
    }
  }
}

TEST(SurfaceMesh, EveryPolygonKeepsItsAreaMaterialAndUv) {
  PolygonSoup soup =
      test::make_soup({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}, {0, 0, 2}},
                      {{0, 1, 2, 3, 4, 5}, {1, 0, 6}});
  soup.face_material = {3, 5};
  for (const Vec3& p : soup.positions) soup.uvs.emplace_back(p.x() + p.z(), p.y());
  soup.corner_uv = soup.corner_position;
  const SurfaceMesh mesh = build_surface_mesh(soup);
  std::map<std::uint32_t, double> area;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    area[mesh.source_polygon(f)] += mesh.face_area(f);
    EXPECT_EQ(mesh.material(f), mesh.source_polygon(f) == 0 ? 3u : 5u);
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.positions(f)[static_cast<std::size_t>(k)];
      EXPECT_EQ(mesh.corner_uv(f, k), Vec2(p.x() + p.z(), p.y()));
    }
  }
  EXPECT_NEAR(area[0], 5.0, 1e-14);
  EXPECT_NEAR(area[1], 3.0, 1e-14);
  EXPECT_NEAR(mesh.report().area, 8.0, 1e-14);
  EXPECT_EQ(mesh.report().triangulated_polygons, 1u);
}

TEST(SurfaceMesh, ReversedFacesTakeTheirNormalsAlong) {
  PolygonSoup soup = test::make_torus(2.0, 0.5, 24, 16, 0.0, true);
  // One face is wound the wrong way round with normals to match, one with the outward normals.
  soup.normals.push_back(-soup.normals[soup.corner_normal[0]]);
  for (const std::size_t f : {std::size_t{0}, std::size_t{40}}) {
    const auto begin = soup.face_begin[f];
    std::swap(soup.corner_position[begin + 1], soup.corner_position[begin + 3]);
    std::swap(soup.corner_normal[begin + 1], soup.corner_normal[begin + 3]);
  }
  const std::size_t original = soup.normals.size() - 1;
  for (std::uint32_t c = 0; c < 4; ++c) {
    soup.normals.push_back(-soup.normals[soup.corner_normal[c]]);
    soup.corner_normal[c] = static_cast<std::uint32_t>(soup.normals.size() - 1);
  }
  ASSERT_GT(soup.normals.size(), original);
  const SurfaceMesh mesh = build_surface_mesh(soup);
  EXPECT_EQ(mesh.report().flipped_faces, 4u);
  EXPECT_EQ(mesh.region_count(), 1u);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) EXPECT_GT(mesh.corner_normal(f, k).dot(mesh.face_normal(f)), 0.9);
  }
}

TEST(SurfaceMesh, InsideOutNormalsFollowTheFaces) {
  PolygonSoup soup = make_sphere(Vec3::Zero(), 1.0, 6);
  for (Vec3& n : soup.normals) n = -n;
  const SurfaceMesh mesh = build_surface_mesh(soup);
  EXPECT_EQ(mesh.report().flipped_faces, 0u);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    EXPECT_GT(mesh.corner_normal(f, 0).dot(mesh.face_normal(f)), 0.9);
  }
}

TEST(SurfaceMesh, SuppliedNormalsAreKept) {
  const SurfaceMesh mesh = build_surface_mesh(make_sphere(Vec3(3, 2, 1), 2.0, 5));
  for (std::size_t s = 0; s < mesh.sector_count(); ++s) EXPECT_TRUE(mesh.normal_is_supplied(s));
  const SurfaceMesh plain = build_surface_mesh(test::make_tetrahedron());
  for (std::size_t s = 0; s < plain.sector_count(); ++s) EXPECT_FALSE(plain.normal_is_supplied(s));
  EXPECT_FALSE(plain.has_uvs());
  EXPECT_EQ(plain.corner_uv(0, 0), Vec2(0, 0));
}

TEST(SurfaceMesh, BoundsAndAreaOfACube) {
  const MeshReport report = build_surface_mesh(make_cube()).report();
  EXPECT_DOUBLE_EQ(report.area, 24.0);
  EXPECT_EQ(report.bounds.min(), Vec3(-1, -1, -1));
  EXPECT_EQ(report.bounds.max(), Vec3(1, 1, 1));
}

TEST(SurfaceMesh, RandomHeapsOfTrianglesAreTaken) {
  test::SeededBits random(23);
  for (int round = 0; round < 100; ++round) {
    std::vector<Vec3> positions;
    for (int i = 0; i < 12; ++i) positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
    test::FaceList faces;
    for (std::size_t i = 0; i < 1 + random.below(120); ++i) {
      std::vector<std::uint32_t> face;
      for (std::size_t k = 0; k < 3 + random.below(3); ++k)
        face.push_back(static_cast<std::uint32_t>(random.below(12)));
      while (face.size() < 3) face.push_back(0);
      faces.push_back(face);
    }
    const PolygonSoup soup = test::make_soup(positions, faces);
    const SurfaceMesh mesh = build_surface_mesh(soup);
    EXPECT_EQ(mesh.face_count(), repair_mesh(soup).triangles.size());
    for (std::size_t s = 0; s < mesh.sector_count(); ++s) {
      for (std::size_t f = 0; f < mesh.face_count(); ++f)
        ASSERT_NEAR(mesh.corner_normal(f, 0).norm(), 1.0, 1e-12);
      break;
    }
  }
}

TEST(SurfaceMesh, InvalidSoupIsRefused) {
  PolygonSoup soup = test::make_tetrahedron();
  soup.corner_position[5] = 9;
  EXPECT_THROW((void)build_surface_mesh(soup), InputError);
}

TEST(SurfaceMesh, EmptySoupIsAnEmptyMesh) {
  const SurfaceMesh mesh = build_surface_mesh(PolygonSoup{});
  EXPECT_EQ(mesh.face_count(), 0u);
  EXPECT_EQ(mesh.region_count(), 0u);
  EXPECT_FALSE(mesh.report().watertight);
  EXPECT_TRUE(mesh.report().bounds.isEmpty());
}

}  // namespace
}  // namespace vrc
