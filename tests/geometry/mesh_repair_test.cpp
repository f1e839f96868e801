// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "sample_meshes.h"
#include "support.h"

namespace vrc {
namespace {

using test::make_soup;
using testing::ElementsAre;

double area(const RepairedMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += 0.5 * (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm();
  }
  return sum;
}

double signed_volume(const RepairedMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c])) / 6.0;
  }
  return sum;
}

// Planar polygons only.
double area(const PolygonSoup& soup) {
  double sum = 0.0;
  for (std::size_t f = 0; f < soup.face_count(); ++f) {
    std::vector<Vec3> corners;
    for (const std::uint32_t v : soup.face_positions(f)) corners.push_back(soup.positions[v]);
    sum += 0.5 * newell_normal(corners).norm();
  }
  return sum;
}

// What a half-edge structure needs: no directed edge twice, and one fan at each vertex.
void expect_oriented_manifold(const RepairedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> face_of_edge;
  std::map<std::uint32_t, std::set<std::size_t>> faces_at;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[f][k];
      const std::uint32_t b = mesh.triangles[f][(k + 1) % 3];
      EXPECT_TRUE(face_of_edge.try_emplace({a, b}, f).second) << "edge " << a << ' ' << b;
      faces_at[a].insert(f);
    }
  }
  EXPECT_EQ(faces_at.size(), mesh.positions.size()) << "a vertex without faces";
  for (auto& [vertex, faces] : faces_at) {
    std::vector<std::size_t> reached{*faces.begin()};
    faces.erase(faces.begin());
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.triangles[reached[i]][k];
        const std::uint32_t b = mesh.triangles[reached[i]][(k + 1) % 3];
        const auto other = face_of_edge.find({b, a});
        if ((a != vertex && b != vertex) || other == face_of_edge.end()) continue;
        if (faces.erase(other->second) != 0) reached.push_back(other->second);
      }
    }
    EXPECT_TRUE(faces.empty()) << "several fans at vertex " << vertex;
  }
}

TEST(MeshRepair, SamplesBecomeOrientedManifoldsOfTheSameArea) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    const RepairedMesh mesh = repair_mesh(soup);
    expect_oriented_manifold(mesh);
    const bool has_bent_quads = name == "height field" || name == "moebius strip" || name == "sphere";
    EXPECT_NEAR(area(mesh), area(soup), (has_bent_quads ? 0.02 : 1e-9) * area(soup));
    EXPECT_EQ(mesh.report.degenerate_faces, 0u);
    EXPECT_EQ(mesh.report.duplicate_faces, 0u);
    EXPECT_EQ(mesh.report.non_manifold_edges, 0u);
    EXPECT_EQ(mesh.report.non_manifold_vertices, 0u);
    EXPECT_EQ(mesh.report.isolated_vertices, 0u);
    EXPECT_EQ(mesh.report.orientation_cuts > 0, name == "moebius strip");
  }
}

TEST(MeshRepair, TrianglesAreInSourceOrder) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    const RepairedMesh mesh = repair_mesh(soup);
    EXPECT_TRUE(std::is_sorted(mesh.source_polygon.begin(), mesh.source_polygon.end()));
    ASSERT_EQ(mesh.source_corner.size(), 3 * mesh.triangles.size());
    for (std::size_t c = 0; c < mesh.source_corner.size(); ++c) {
      const std::uint32_t polygon = mesh.source_polygon[c / 3];
      EXPECT_GE(mesh.source_corner[c], soup.face_begin[polygon]);
      EXPECT_LT(mesh.source_corner[c], soup.face_begin[polygon + 1]);
      EXPECT_EQ(mesh.positions[mesh.triangles[c / 3][c % 3]],
                soup.positions[soup.corner_position[mesh.source_corner[c]]]);
    }
  }
}

TEST(MeshRepair, CleanTrianglesKeepTheirNumbers) {
  const PolygonSoup soup = test::make_tetrahedron();
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_EQ(mesh.positions, soup.positions);
  EXPECT_THAT(mesh.triangles,
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 3, 1}, Triangle{0, 2, 3}, Triangle{1, 3, 2}));
}

TEST(MeshRepair, WeldsEqualPositionsIncludingMinusZero) {
  const PolygonSoup soup = make_soup(
      {{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, -0.0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {3, 4, 5}});
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_EQ(mesh.report.welded_vertices, 2u);
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.report.vertex_copies, 0u);
}

TEST(MeshRepair, ToleranceIsRelativeToTheBoundingBox) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const double gap = 1e-5 * scale;  // diagonal of the box: about 1.7 scale
    PolygonSoup soup = make_soup(
        {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {-gap, 0, 0}, {0, scale + gap, 0}, {-scale, 0, 0}},
        {{0, 1, 2}, {3, 4, 5}});
    EXPECT_EQ(repair_mesh(soup).report.welded_vertices, 0u);
    EXPECT_EQ(repair_mesh(soup, {.weld_tolerance = 1e-6}).report.welded_vertices, 0u);
    EXPECT_EQ(repair_mesh(soup, {.weld_tolerance = 1e-4}).report.welded_vertices, 2u);
  }
}

TEST(MeshRepair, ToleranceMergesAcrossCellBorders) {
  test::SeededBits random(3);
  std::vector<Vec3> positions;
  test::FaceList faces;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Vec3 p(random.uniform(), random.uniform(), random.uniform());
    positions.push_back(p);
    positions.push_back(p +
                        1e-7 * Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5));
  }
  for (std::uint32_t i = 0; i + 4 < positions.size(); i += 6) faces.push_back({i, i + 2, i + 4});
  const RepairedMesh mesh = repair_mesh(make_soup(positions, faces), {.weld_tolerance = 1e-7});
  EXPECT_EQ(mesh.report.welded_vertices, 300u);
}

TEST(MeshRepair, DropsDegenerateFaces) {
  const PolygonSoup soup = make_soup(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {0.1, 0.1, 0.1}, {0.3, 0.3, 0.3}, {0.7, 0.7, 0.7}},
      {{0, 1, 1}, {0, 1, 3}, {0, 1, 2}, {4, 5, 6}, {1, 1, 1, 1}});
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_THAT(mesh.source_polygon, ElementsAre(2u));
  EXPECT_EQ(mesh.report.degenerate_faces, 4u);
  EXPECT_EQ(mesh.report.isolated_vertices, 4u);
  EXPECT_EQ(mesh.positions.size(), 3u);
}

TEST(MeshRepair, ADoubledCornerIsNoLoss) {
  const PolygonSoup soup = make_soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 1, 2, 0}});
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.report.degenerate_faces, 0u);
}

TEST(MeshRepair, SmallAndFarTrianglesAreNotDegenerate) {
  for (const double scale : {1e-12, 1e-3, 1e12}) {
    PolygonSoup soup = test::make_tetrahedron();
    for (Vec3& p : soup.positions) p *= scale;
    EXPECT_EQ(repair_mesh(soup).triangles.size(), 4u) << scale;
  }
  PolygonSoup needle = make_soup({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}}, {{0, 1, 2}});
  EXPECT_EQ(repair_mesh(needle).triangles.size(), 1u);
}

TEST(MeshRepair, DropsDuplicatesEitherWayRound) {
  const PolygonSoup soup = make_soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                     {{0, 1, 2, 3}, {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2}});
  const RepairedMesh mesh = repair_mesh(make_soup(soup.positions, {{0, 1, 2}, {2, 0, 1}, {1, 0, 2}}));
  EXPECT_EQ(mesh.report.duplicate_faces, 2u);
  EXPECT_EQ(mesh.triangles.size(), 1u);
  const RepairedMesh quads =
      repair_mesh(make_soup(soup.positions, {{0, 1, 2, 3}, {2, 3, 0, 1}, {1, 0, 3, 2}}));
  EXPECT_EQ(quads.report.duplicate_faces, 2u);
  EXPECT_EQ(quads.triangles.size(), 2u);
}

TEST(MeshRepair, PolygonsOfTheSameVerticesInAnotherOrderAreNotDuplicates) {
  const std::vector<Vec3> points{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 1, 0}};
  const RepairedMesh mesh = repair_mesh(make_soup(points, {{0, 4, 1, 2, 3}, {0, 1, 4, 2, 3}}));
  EXPECT_EQ(mesh.report.duplicate_faces, 0u);
  expect_oriented_manifold(mesh);
}

TEST(MeshRepair, TurnsTheMinorityRound) {
  PolygonSoup soup = test::make_torus(2.0, 0.5, 12, 8);
  std::swap(soup.corner_position[0], soup.corner_position[2]);  // reverses quad 0
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_EQ(mesh.report.flipped_faces, 2u);
  EXPECT_EQ(mesh.flipped[0], 1);
  EXPECT_EQ(mesh.flipped[1], 1);
  EXPECT_EQ(mesh.flipped[2], 0);
  EXPECT_EQ(mesh.report.orientation_cuts, 0u);
  expect_oriented_manifold(mesh);
  const double expected = signed_volume(repair_mesh(test::make_torus(2.0, 0.5, 12, 8)));
  EXPECT_NEAR(signed_volume(mesh), expected, 1e-12);
}

TEST(MeshRepair, RandomFlipsAreUndone) {
  test::SeededBits random(11);
  PolygonSoup soup = test::make_torus(2.0, 0.5, 16, 10);
  std::size_t reversed = 0;
  for (std::size_t f = 0; f < soup.face_count(); ++f) {
    if (random.below(4) != 0) continue;
    std::reverse(soup.corner_position.begin() + soup.face_begin[f],
                 soup.corner_position.begin() + soup.face_begin[f + 1]);
    ++reversed;
  }
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_EQ(mesh.report.flipped_faces, 2 * reversed);
  EXPECT_EQ(mesh.report.vertex_copies, 0u);
  expect_oriented_manifold(mesh);
}

TEST(MeshRepair, AnInsideOutSolidStaysUnlessAskedFor) {
  PolygonSoup soup = test::make_tetrahedron();
  for (std::size_t f = 0; f < 4; ++f) std::swap(soup.corner_position[3 * f], soup.corner_position[3 * f + 1]);
  EXPECT_LT(signed_volume(repair_mesh(soup)), 0.0);
  EXPECT_EQ(repair_mesh(soup).report.flipped_faces, 0u);
  const RepairedMesh outward = repair_mesh(soup, {.orient_outward = true});
  EXPECT_GT(signed_volume(outward), 0.0);
  EXPECT_EQ(outward.report.flipped_faces, 4u);
  EXPECT_EQ(repair_mesh(test::make_tetrahedron(), {.orient_outward = true}).report.flipped_faces, 0u);
}

TEST(MeshRepair, ThreeFacesOnAnEdgeAreDetached) {
  const PolygonSoup soup = make_soup({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                                     {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_EQ(mesh.report.non_manifold_edges, 1u);
  EXPECT_EQ(mesh.report.non_manifold_vertices, 0u);
  EXPECT_EQ(mesh.report.vertex_copies, 4u);
  EXPECT_EQ(mesh.positions.size(), 9u);
  EXPECT_THAT(mesh.detached_edge, ElementsAre(1, 0, 0, 1, 0, 0, 1, 0, 0));
  expect_oriented_manifold(mesh);
}

TEST(MeshRepair, AFinOnAClosedSurfaceLeavesItClosed) {
  PolygonSoup soup = test::make_tetrahedron();
  soup.positions.push_back({3, 0, 1});
  soup.add_face(std::vector<std::uint32_t>{0, 1, 4});
  const RepairedMesh mesh = repair_mesh(soup);
  expect_oriented_manifold(mesh);
  EXPECT_EQ(mesh.report.non_manifold_edges, 1u);
  EXPECT_EQ(mesh.positions.size(), 7u);  // the tetrahedron's 4 and the fin's own 3
  EXPECT_EQ(mesh.report.flipped_faces, 0u);
}

TEST(MeshRepair, CubesSharingAnEdgeOrAFaceComeApart) {
  for (const Vec3& offset : {Vec3(2, 2, 0), Vec3(2, 0, 0)}) {
    PolygonSoup soup = test::without_normals(make_cube());
    soup.uvs.clear();
    soup.corner_uv.clear();
    const double single = area(soup);
    test::append(soup, make_cube(), offset);
    const RepairedMesh mesh = repair_mesh(soup);
    expect_oriented_manifold(mesh);
    const bool shares_face = offset.y() == 0.0;
    EXPECT_EQ(mesh.report.duplicate_faces, shares_face ? 1u : 0u);
    EXPECT_EQ(mesh.report.non_manifold_edges, shares_face ? 4u : 1u);
    EXPECT_NEAR(area(mesh), 2.0 * single - (shares_face ? 4.0 : 0.0), 1e-12);
  }
}

TEST(MeshRepair, BowTieVertexIsSplit) {
  const PolygonSoup soup =
      make_soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_EQ(mesh.report.non_manifold_vertices, 1u);
  EXPECT_EQ(mesh.report.vertex_copies, 1u);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{5, 3, 4}));
  EXPECT_EQ(mesh.positions[5], Vec3(0, 0, 0));
  expect_oriented_manifold(mesh);
}

TEST(MeshRepair, MoebiusStripIsCutOnce) {
  const RepairedMesh mesh = repair_mesh(test::make_moebius_strip(20));
  EXPECT_EQ(mesh.report.orientation_cuts, 1u);
  EXPECT_EQ(mesh.report.vertex_copies, 2u);
  EXPECT_EQ(mesh.report.non_manifold_vertices, 0u);
  EXPECT_EQ(mesh.triangles.size(), 40u);
  EXPECT_EQ(std::count(mesh.detached_edge.begin(), mesh.detached_edge.end(), 1), 2);
  expect_oriented_manifold(mesh);
}

TEST(MeshRepair, RandomTriangleHeapsLoseNothing) {
  // Every kind of defect at once: few points, many faces.
  test::SeededBits random(5);
  for (int round = 0; round < 60; ++round) {
    std::vector<Vec3> positions;
    for (int i = 0; i < 9; ++i) positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
    test::FaceList faces;
    std::set<std::set<std::uint32_t>> distinct;
    for (std::size_t i = 0; i < 5 + random.below(60); ++i) {
      std::vector<std::uint32_t> face;
      for (int k = 0; k < 3; ++k) face.push_back(static_cast<std::uint32_t>(random.below(9)));
      const std::set<std::uint32_t> vertices(face.begin(), face.end());
      if (vertices.size() == 3) distinct.insert(vertices);
      faces.push_back(face);
    }
    const RepairedMesh mesh = repair_mesh(make_soup(positions, faces));
    EXPECT_EQ(mesh.triangles.size(), distinct.size());
    EXPECT_EQ(mesh.report.degenerate_faces + mesh.report.duplicate_faces + mesh.triangles.size(),
              faces.size());
    expect_oriented_manifold(mesh);
  }
}

TEST(MeshRepair, TJunctionStaysOpen) {
  const PolygonSoup soup =
      make_soup({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 0, 0}, {1, -1, 0}}, {{0, 1, 2}, {0, 4, 3}, {3, 4, 1}});
  const RepairedMesh mesh = repair_mesh(soup);
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.report.non_manifold_edges, 0u);
  EXPECT_EQ(mesh.report.vertex_copies, 2u);  // both ends of the long edge touch two fans
  expect_oriented_manifold(mesh);
}

TEST(MeshRepair, EmptySoup) {
  const RepairedMesh mesh = repair_mesh(PolygonSoup{});
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(mesh.positions.empty());
}

}  // namespace
}  // namespace vrc
