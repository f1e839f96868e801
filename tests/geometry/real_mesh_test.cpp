// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold on any mesh, on scanned and modelled ones from outside the repository where they are
// at hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <vector>

#include "geometry/curvature.h"
#include "geometry/patch_atlas.h"
#include "geometry/surface_walker.h"
#include "io/obj_reader.h"
#include "io/ply_reader.h"
#include "real_meshes.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

const Vec3 kCentre(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0);

PolygonSoup read_model(const fs::path& path) {
  return path.extension() == ".obj" ? read_obj(path).soup : read_ply(path);
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double uv_area(const PatchAtlas& atlas, std::size_t f) {
  return 0.5 * cross(atlas.uv(f, 1) - atlas.uv(f, 0), atlas.uv(f, 2) - atlas.uv(f, 0));
}

template <typename Check>
void for_each_model(const Check& check) {
  for (const fs::path& path : test::real_meshes()) {
    SCOPED_TRACE(path.filename().string());
    const PolygonSoup soup = read_model(path);
    check(soup, build_surface_mesh(soup));
  }
}

#define SKIP_WITHOUT_MODELS()      \
  if (test::real_meshes().empty()) \
  GTEST_SKIP() << "no meshes in shared/models beside the repository nor in /usr/share/glmark2/models"

// Every polygon of the file is there, whole, but for those that the report says were left out.
TEST(RealMesh, EveryFaceIsRetained) {
  SKIP_WITHOUT_MODELS();
  for_each_model([](const PolygonSoup& soup, const SurfaceMesh& mesh) {
    const MeshReport& report = mesh.report();
    std::set<std::uint32_t> polygons;
    double area = 0.0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      polygons.insert(mesh.source_polygon(f));
      area += mesh.face_area(f);
    }
    double left_out = 0.0;
    double soup_area = 0.0;
    for (std::uint32_t f = 0; f < soup.face_count(); ++f) {
      const auto corners = soup.face_positions(f);
      Vec3 normal = Vec3::Zero();  // Newell.
      for (std::size_t k = 0; k < corners.size(); ++k) {
        normal +=
            0.5 * (soup.positions[corners[k]] - soup.positions[corners[0]])
                      .cross(soup.positions[corners[(k + 1) % corners.size()]] - soup.positions[corners[0]]);
      }
      soup_area += normal.norm();
      if (polygons.count(f) == 0) left_out += normal.norm();
    }
    EXPECT_GE(polygons.size() + report.degenerate_faces + report.duplicate_faces, soup.face_count());
    EXPECT_NEAR(area + left_out, soup_area, 0.02 * soup_area) << "polygons that are not plane differ";
    if (report.duplicate_faces == 0) {
      EXPECT_LT(left_out, 1e-9 * soup_area);
    }
  });
}

// The integral of the estimated Gaussian curvature, on meshes fine enough to resolve their shape and
// with next to no creases, whose bends it leaves out.
TEST(RealMesh, FineClosedMeshesObeyGaussBonnet) {
  SKIP_WITHOUT_MODELS();
  std::size_t tested = 0;
  for_each_model([&tested](const PolygonSoup&, const SurfaceMesh& mesh) {
    const MeshReport& report = mesh.report();
    const auto creases = static_cast<std::size_t>(
        std::count_if(mesh.creases().begin(), mesh.creases().end(), [](std::uint8_t c) { return c != 0; }));
    if (!report.watertight || report.components != 1 || 500 * creases > mesh.edge_count()) return;
    ++tested;
    const CurvatureField field = estimate_curvature(mesh);
    double sum = 0.0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const Vec3 normal =
          (mesh.corner_normal(f, 0) + mesh.corner_normal(f, 1) + mesh.corner_normal(f, 2)).normalized();
      const PrincipalCurvatures k = principal_curvatures(field.shape_operator(f, kCentre), normal);
      sum += mesh.face_area(f) * k.k1 * k.k2;
    }
    const double characteristic = 2.0 - 2.0 * static_cast<double>(report.genus);
    EXPECT_NEAR(sum, 2.0 * kPi * characteristic, 0.15 * 4.0 * kPi);
  });
  if (tested == 0) GTEST_SKIP() << "none of the meshes is closed, in one piece and nearly without creases";
}

TEST(RealMesh, CurvatureIsFiniteSymmetricAndTangent) {
  SKIP_WITHOUT_MODELS();
  for_each_model([](const PolygonSoup&, const SurfaceMesh& mesh) {
    const CurvatureField field = estimate_curvature(mesh);
    for (std::size_t s = 0; s < mesh.sector_count(); ++s) {
      const Mat3 shape = field.shape_operator(s);
      ASSERT_TRUE(shape.allFinite());
      ASSERT_LE((shape - shape.transpose()).norm(), 1e-12 * shape.norm());
      ASSERT_LE((shape * mesh.sector_normal(s)).norm(), 1e-9 * shape.norm());
    }
  });
}

// The middles of some faces lie in no other face of their chart.
void expect_apart(const PatchAtlas& atlas) {
  const std::size_t count = atlas.mesh().face_count();
  const std::size_t step = std::max<std::size_t>(1, count / 400);
  for (std::size_t f = 0; f < count; f += step) {
    const Vec2 uv = atlas.uv(f, kCentre);
    for (const std::uint32_t other : atlas.faces(atlas.patch_of(f))) {
      bool inside = other != f;
      for (int k = 0; k < 3 && inside; ++k) {
        const Vec2& a = atlas.uv(other, k);
        inside = cross(atlas.uv(other, (k + 1) % 3) - a, uv - a) > 0.0;
      }
      ASSERT_FALSE(inside) << "faces " << f << " and " << other;
    }
  }
}

TEST(RealMesh, ChartsAreValid) {
  SKIP_WITHOUT_MODELS();
  for_each_model([](const PolygonSoup&, const SurfaceMesh& mesh) {
    const PatchAtlasOptions options;
    const PatchAtlas atlas = build_patch_atlas(mesh, options);
    EXPECT_EQ(atlas.quality().flipped_faces, 0u);
    EXPECT_LE(atlas.quality().max_stretch, options.max_stretch * (1.0 + 1e-6));
    EXPECT_LE(atlas.quality().max_area_distortion, options.max_area_distortion * (1.0 + 1e-6));
    EXPECT_LT(atlas.quality().mean_stretch, 1.2);
    std::size_t faces = 0;
    for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
      double in_uv = 0.0;
      for (const std::uint32_t f : atlas.faces(p)) {
        ASSERT_EQ(atlas.patch_of(f), p);
        ASSERT_GT(uv_area(atlas, f), 0.0);
        in_uv += uv_area(atlas, f);
      }
      faces += atlas.faces(p).size();
      EXPECT_NEAR(in_uv, atlas.patch(p).area, 1e-5 * in_uv);
    }
    EXPECT_EQ(faces, mesh.face_count());
    expect_apart(atlas);
  });
}

// Areas and edges keep their size, neighbours are reached over smooth edges, and nothing outside the
// region of the ellipse is.
TEST(RealMesh, WalksAreSound) {
  SKIP_WITHOUT_MODELS();
  for_each_model([](const PolygonSoup&, const SurfaceMesh& mesh) {
    const double reach = 0.02 * mesh.report().bounds.diagonal().norm();
    const std::size_t step = std::max<std::size_t>(1, mesh.face_count() / 60);
    for (std::uint32_t f = 0; f < mesh.face_count(); f += static_cast<std::uint32_t>(step)) {
      const Vec3 along = mesh.positions(f)[1] - mesh.positions(f)[0];
      const SurfaceEllipse ellipse = make_ellipse(mesh, f, kCentre, along, Vec2(reach, 0.5 * reach));
      const double side = mesh.face_normal(f).dot(ellipse.frame.normal) < 0.0 ? -1.0 : 1.0;
      std::set<std::uint32_t> reached;
      for (const WalkedFace& walked : walk_surface(mesh, ellipse).faces) {
        const auto& c = walked.corners;
        const double area = mesh.face_area(walked.face);
        const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
        ASSERT_NEAR(0.5 * cross(c[1] - c[0], c[2] - c[0]), side * area,
                    1e-6 * area + 1e-12 * longest * longest);
        ASSERT_EQ(mesh.region(walked.face), mesh.region(f));
        bool entered = reached.empty();
        for (int k = 0; k < 3; ++k) {
          entered = entered || (mesh.crease(mesh.edge(walked.face, k)) == 0 &&
                                reached.count(mesh.neighbour(walked.face, k)) != 0);
        }
        ASSERT_TRUE(entered) << "face " << walked.face << " is not beside one reached before";
        ASSERT_TRUE(reached.insert(walked.face).second);
      }
    }
  });
}

}  // namespace
}  // namespace vrc
