// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/patch_atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/parallel.h"
#include "geometry/curvature.h"
#include "sample_meshes.h"
#include "support.h"

namespace vrc {
namespace {

using test::make_soup;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double uv_area(const PatchAtlas& atlas, std::size_t f) {
  return 0.5 * cross(atlas.uv(f, 1) - atlas.uv(f, 0), atlas.uv(f, 2) - atlas.uv(f, 0));
}

// By the separating axes of both; touching is none.
bool overlap(const std::array<Vec2, 3>& s, const std::array<Vec2, 3>& t, double tolerance) {
  for (const auto* triangle : {&s, &t}) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 d = ((*triangle)[(k + 1) % 3] - (*triangle)[k]).normalized();
      double s_low = 1e300, s_high = -1e300, t_low = 1e300, t_high = -1e300;
      for (std::size_t i = 0; i < 3; ++i) {
        s_low = std::min(s_low, cross(d, s[i]));
        s_high = std::max(s_high, cross(d, s[i]));
        t_low = std::min(t_low, cross(d, t[i]));
        t_high = std::max(t_high, cross(d, t[i]));
      }
      if (s_high <= t_low + tolerance || t_high <= s_low + tolerance) return false;
    }
  }
  return true;
}

std::array<Vec2, 3> uv_triangle(const PatchAtlas& atlas, std::size_t f) {
  return {atlas.uv(f, 0), atlas.uv(f, 1), atlas.uv(f, 2)};
}

void expect_partition(const PatchAtlas& atlas) {
  const SurfaceMesh& mesh = atlas.mesh();
  std::vector<int> seen(mesh.face_count(), 0);
  std::uint32_t previous_first = 0;
  for (std::uint32_t p = 0; p < atlas.patch_count(); ++p) {
    const auto faces = atlas.faces(p);
    ASSERT_FALSE(faces.empty());
    EXPECT_TRUE(std::is_sorted(faces.begin(), faces.end()));
    EXPECT_LE(previous_first, faces.front());
    previous_first = faces.front();
    for (const std::uint32_t f : faces) {
      ++seen[f];
      EXPECT_EQ(atlas.patch_of(f), p);
    }
  }
  EXPECT_EQ(seen, std::vector<int>(mesh.face_count(), 1));
}

// Each patch is connected over smooth edges.
void expect_no_crossed_crease(const PatchAtlas& atlas) {
  const SurfaceMesh& mesh = atlas.mesh();
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
    std::vector<std::uint32_t> reached{atlas.faces(p).front()};
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t n = mesh.neighbour(reached[i], k);
        if (n == kInvalidIndex || mesh.crease(mesh.edge(reached[i], k)) != 0) continue;
        if (atlas.patch_of(n) != p || std::find(reached.begin(), reached.end(), n) != reached.end()) continue;
        reached.push_back(n);
      }
    }
    EXPECT_EQ(reached.size(), atlas.faces(p).size()) << "patch " << p;
  }
}

void expect_good_maps(const PatchAtlas& atlas, const PatchAtlasOptions& options) {
  const SurfaceMesh& mesh = atlas.mesh();
  EXPECT_EQ(atlas.quality().flipped_faces, 0u);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    EXPECT_GT(uv_area(atlas, f), 0.0);
    const Vec2 s = atlas.singular_values(f);
    EXPECT_LE(s[0], (options.max_stretch + 1e-6) * s[1]);
    EXPECT_NEAR(s[0] * s[1], uv_area(atlas, f) / mesh.face_area(f), 1e-5 * s[0] * s[1]);
    const Mat32 jacobian = atlas.jacobian(f);
    const auto p = mesh.positions(f);
    const double longest = std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()});
    const double sliver = longest * longest / mesh.face_area(f);  // Rounding grows with it.
    for (int k = 0; k < 3; ++k) {
      const Vec3 edge = p[static_cast<std::size_t>((k + 1) % 3)] - p[static_cast<std::size_t>(k)];
      const Vec2 uv_edge = atlas.uv(f, (k + 1) % 3) - atlas.uv(f, k);
      EXPECT_LT((jacobian * uv_edge - edge).norm(), (1e-12 + 1e-15 * sliver) * longest);
    }
  }
}

void expect_true_to_area(const PatchAtlas& atlas) {
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
    double in_uv = 0.0;
    double on_surface = 0.0;
    for (const std::uint32_t f : atlas.faces(p)) {
      in_uv += uv_area(atlas, f);
      on_surface += atlas.mesh().face_area(f);
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(atlas.uv(f, k).minCoeff(), -1e-12);
        EXPECT_LE((atlas.uv(f, k) - atlas.patch(p).uv_size).maxCoeff(), 0.0);
      }
    }
    EXPECT_NEAR(in_uv, on_surface, 1e-5 * on_surface);
    EXPECT_NEAR(atlas.patch(p).area, on_surface, 1e-5 * on_surface);
  }
}

void expect_injective(const PatchAtlas& atlas) {
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
    const auto faces = atlas.faces(p);
    const double tolerance = 1e-6 * std::sqrt(atlas.patch(p).area);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        EXPECT_FALSE(overlap(uv_triangle(atlas, faces[i]), uv_triangle(atlas, faces[j]), tolerance))
            << "faces " << faces[i] << " and " << faces[j] << " of patch " << p;
      }
    }
  }
}

// Corners that share a vertex share (u, v) over the smooth edges inside a patch.
void expect_continuous(const PatchAtlas& atlas) {
  const SurfaceMesh& mesh = atlas.mesh();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t n = mesh.neighbour(f, k);
      if (n == kInvalidIndex || mesh.crease(mesh.edge(f, k)) != 0 || atlas.patch_of(n) != atlas.patch_of(f))
        continue;
      for (const int end : {k, (k + 1) % 3}) {
        for (int j = 0; j < 3; ++j) {
          if (mesh.triangle(n)[static_cast<std::size_t>(j)] !=
              mesh.triangle(f)[static_cast<std::size_t>(end)])
            continue;
          EXPECT_EQ(atlas.uv(n, j), atlas.uv(f, end));
        }
      }
    }
  }
}

void expect_frames(const PatchAtlas& atlas) {
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
    const Frame& frame = atlas.patch(p).frame;
    EXPECT_NEAR(frame.normal.norm(), 1.0, 1e-12);
    EXPECT_NEAR(frame.tangent.norm(), 1.0, 1e-12);
    EXPECT_LT((frame.normal.cross(frame.tangent) - frame.bitangent).norm(), 1e-12);
    Vec3 mean = Vec3::Zero();
    Vec3 along_u = Vec3::Zero();
    for (const std::uint32_t f : atlas.faces(p)) {
      mean += atlas.mesh().face_area(f) * atlas.mesh().face_normal(f);
      along_u += uv_area(atlas, f) * atlas.jacobian(f).col(0);
    }
    EXPECT_GT(frame.normal.dot(mean.normalized()), 1.0 - 1e-9);
    EXPECT_NEAR(frame.bitangent.dot(along_u) / along_u.norm(), 0.0, 1e-6);
    EXPECT_GT(frame.tangent.dot(along_u), 0.0);
    for (const std::uint32_t q : atlas.neighbours(p)) {
      const auto back = atlas.neighbours(q);
      EXPECT_TRUE(std::binary_search(back.begin(), back.end(), p));
      const Mat2 there_and_back = atlas.transport(q, p) * atlas.transport(p, q);
      EXPECT_LT((there_and_back - Mat2::Identity()).norm(), 1e-12);
    }
  }
}

void expect_layout_without_overlap(const PatchAtlas& atlas) {
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
    const Patch& a = atlas.patch(p);
    EXPECT_GT(a.layout_offset.minCoeff(), 0.0);
    EXPECT_LT((a.layout_offset + a.uv_size - atlas.layout_size()).maxCoeff(), 0.0);
    for (std::size_t q = p + 1; q < atlas.patch_count(); ++q) {
      const Patch& b = atlas.patch(q);
      const bool apart = (a.layout_offset + a.uv_size - b.layout_offset).minCoeff() < 0.0 ||
                         (b.layout_offset + b.uv_size - a.layout_offset).minCoeff() < 0.0;
      EXPECT_TRUE(apart) << "patches " << p << " and " << q;
    }
  }
}

void expect_valid(const SurfaceMesh& mesh, const PatchAtlasOptions& options = {}) {
  const PatchAtlas atlas = build_patch_atlas(mesh, options);
  expect_partition(atlas);
  expect_no_crossed_crease(atlas);
  expect_good_maps(atlas, options);
  expect_true_to_area(atlas);
  expect_injective(atlas);
  expect_continuous(atlas);
  expect_frames(atlas);
  expect_layout_without_overlap(atlas);
}

// Random triangles over few points: non-manifold edges, folds, slivers and intersections.
PolygonSoup random_triangles(std::uint64_t seed) {
  test::SeededBits random(seed);
  std::vector<Vec3> positions;
  for (int i = 0; i < 24; ++i) positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
  for (int i = 0; i < 6; ++i)
    positions.push_back(0.5 * (positions[0] + positions[1]) + 1e-9 * positions[2] * i);
  test::FaceList faces;
  for (int i = 0; i < 80; ++i) {
    const auto a = static_cast<std::uint32_t>(random.below(positions.size()));
    const auto b = static_cast<std::uint32_t>(random.below(positions.size()));
    const auto c = static_cast<std::uint32_t>(random.below(positions.size()));
    if (a != b && b != c && c != a) faces.push_back({a, b, c});
  }
  return make_soup(positions, faces);
}

TEST(PatchAtlas, IsValidOnEverySample) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    expect_valid(build_surface_mesh(soup));
  }
}

TEST(PatchAtlas, IsValidWhateverTheCreases) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    SurfaceMeshOptions smooth;
    smooth.creases.crease_angle = 179.0;
    expect_valid(build_surface_mesh(test::without_normals(soup), smooth));
    expect_valid(build_surface_mesh(soup, {.repair = {}, .creases = {}, .face_normals = true}));
  }
}

TEST(PatchAtlas, IsValidOnDefectMeshes) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    SurfaceMeshOptions smooth;
    smooth.creases.crease_angle = 180.0;
    expect_valid(build_surface_mesh(random_triangles(seed), smooth));
  }
}

TEST(PatchAtlas, IsValidWhereEveryMethodIsRefused) {
  PatchAtlasOptions strict;
  strict.max_stretch = 1.0 + 1e-9;
  const SurfaceMesh torus = build_surface_mesh(test::make_torus(2.0, 0.6, 24, 16, 0.5));
  expect_valid(torus, strict);
  EXPECT_GT(build_patch_atlas(torus, strict).quality().patches_by_method[2], 0u);
}

TEST(PatchAtlas, IsValidOnSliversAndNoise) {
  test::SeededBits random(5);
  const PolygonSoup rough = test::make_height_field(
      [&random](double x, double y) { return 0.2 * std::sin(3.0 * x + y) + 0.08 * random.uniform(); }, 24,
      0.9);
  SurfaceMeshOptions smooth;
  smooth.creases.crease_angle = 100.0;
  expect_valid(build_surface_mesh(rough, smooth));
  // A fan of needles with heights from 1e-2 to 1e-10 in an otherwise plane sheet.
  std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}};
  test::FaceList faces;
  double height = 0.0;
  for (std::uint32_t i = 0; i < 5; ++i) {
    height += std::pow(10.0, 2.0 * i - 10.0);
    positions.emplace_back(0.5, height, 1e-3 * height);
    faces.push_back({0, i + 1, i + 2});
  }
  expect_valid(build_surface_mesh(make_soup(positions, faces)));
}

TEST(PatchAtlas, IsValidAtAnyScaleAndPlace) {
  for (const double scale : {1e-9, 1e9}) {
    SCOPED_TRACE(scale);
    PolygonSoup soup = test::make_torus(2.0, 0.6, 24, 16);
    for (Vec3& p : soup.positions) p = scale * (p + Vec3(1e3, -1e3, 1e3));
    expect_valid(build_surface_mesh(soup));
  }
}

TEST(PatchAtlas, FlatFacesKeepTheirShape) {
  const SurfaceMesh cube = build_surface_mesh(make_cube());
  const PatchAtlas atlas = build_patch_atlas(cube);
  EXPECT_EQ(atlas.patch_count(), 6u);
  EXPECT_NEAR(atlas.quality().max_stretch, 1.0, 1e-12);
  EXPECT_NEAR(atlas.quality().max_area_distortion, 1.0, 1e-12);
  for (std::size_t p = 0; p < 6; ++p) {
    EXPECT_EQ(atlas.faces(p).size(), 2u);
    EXPECT_LT((atlas.patch(p).uv_size - Vec2(2.0, 2.0)).norm(), 1e-12) << "the square is aligned";
    EXPECT_TRUE(atlas.neighbours(p).empty());
  }
}

TEST(PatchAtlas, APlaneWithHolesIsOneExactChart) {
  std::vector<Vec3> positions;
  test::FaceList faces;
  constexpr std::uint32_t kSide = 8;
  for (std::uint32_t j = 0; j <= kSide; ++j)
    for (std::uint32_t i = 0; i <= kSide; ++i) positions.emplace_back(i, j, 0.5 * i);
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      if (i % 3 == 1 && j % 3 == 1) continue;
      const std::uint32_t a = j * (kSide + 1) + i;
      faces.push_back({a, a + 1, a + kSide + 2, a + kSide + 1});
    }
  }
  PatchAtlasOptions small;
  small.max_faces = 10;  // Bounds bent charts only.
  const SurfaceMesh mesh = build_surface_mesh(make_soup(positions, faces));
  const PatchAtlas atlas = build_patch_atlas(mesh, small);
  EXPECT_EQ(atlas.patch_count(), 1u);
  EXPECT_EQ(atlas.patch(0).method, ChartMethod::kOrthographic);
  EXPECT_NEAR(atlas.quality().max_stretch, 1.0, 1e-9);
  expect_valid(mesh, small);
}

TEST(PatchAtlas, CurvedShapesAreConformal) {
  const SurfaceMesh sphere = build_surface_mesh(make_sphere(Vec3::Zero(), 1.0, 16));
  const PatchAtlas atlas = build_patch_atlas(sphere);
  EXPECT_LE(atlas.patch_count(), 20u);
  EXPECT_GE(atlas.quality().faces_by_method[0], sphere.face_count() * 9 / 10);
  EXPECT_LT(atlas.quality().mean_stretch, 1.05);
  EXPECT_LT(atlas.quality().mean_area_distortion, 1.25);
}

TEST(PatchAtlas, ACylinderIsUnrolled) {
  const SurfaceMesh cylinder = build_surface_mesh(make_cylinder(Vec3::Zero(), Vec3(0, 0, 3), 1.0, 64));
  const PatchAtlas atlas = build_patch_atlas(cylinder);
  EXPECT_LE(atlas.patch_count(), 5u);
  EXPECT_NEAR(atlas.quality().max_stretch, 1.0, 1e-3);
  EXPECT_NEAR(atlas.quality().max_area_distortion, 1.0, 1e-3);
}

TEST(PatchAtlas, ChartsStayInTheirCones) {
  const SurfaceMesh torus = build_surface_mesh(test::make_torus(2.0, 0.6, 48, 32, 0.5));
  const PatchAtlas atlas = build_patch_atlas(torus);
  for (std::uint32_t f = 0; f < torus.face_count(); ++f) {
    // The axis of growth is near the mean normal, but not the same.
    EXPECT_GT(torus.face_normal(f).dot(atlas.patch(atlas.patch_of(f)).frame.normal),
              std::cos(kPi * 80 / 180));
  }
  std::size_t tiny = 0;
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) tiny += atlas.faces(p).size() < 8 ? 1 : 0;
  EXPECT_LE(tiny, atlas.patch_count() / 10);
}

TEST(PatchAtlas, LargeChartsMayBeProjectedDirectly) {
  PatchAtlasOptions options;
  options.direct_faces = 10;
  const SurfaceMesh mesh = build_surface_mesh(
      test::make_height_field([](double x, double y) { return 0.1 * (x * x + y * y); }, 20));
  EXPECT_EQ(build_patch_atlas(mesh).patch(0).method, ChartMethod::kConformal);
  const PatchAtlas direct = build_patch_atlas(mesh, options);
  ASSERT_EQ(direct.patch_count(), 1u);
  EXPECT_EQ(direct.patch(0).method, ChartMethod::kOrthographic);
  EXPECT_LE(direct.quality().max_stretch, options.direct_stretch);
}

TEST(PatchAtlas, GrowthStopsAtTheFaceLimit) {
  PatchAtlasOptions options;
  options.max_faces = 100;
  const SurfaceMesh mesh = build_surface_mesh(
      test::make_height_field([](double x, double y) { return 0.3 * (x * x + y * y); }, 20));
  const PatchAtlas atlas = build_patch_atlas(mesh, options);
  EXPECT_GE(atlas.patch_count(), 6u);
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) EXPECT_LE(atlas.faces(p).size(), 150u);
  expect_valid(mesh, options);
}

TEST(PatchAtlas, FramesAreCarriedByTheSmallestRotation) {
  const SurfaceMesh sphere = build_surface_mesh(make_sphere(Vec3::Zero(), 1.0, 12));
  const PatchAtlas atlas = build_patch_atlas(sphere);
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
    const Frame& from = atlas.patch(p).frame;
    for (const std::uint32_t q : atlas.neighbours(p)) {
      const Frame& to = atlas.patch(q).frame;
      const Mat2 turn = atlas.transport(p, q);
      const Vec3 carried = minimal_rotation(from.normal, to.normal) * from.tangent;
      EXPECT_LT((turn(0, 0) * to.tangent + turn(1, 0) * to.bitangent - carried).norm(), 1e-9);
      const Frame there = atlas.frame_at(p, to.normal);
      EXPECT_LT((there.tangent - carried).norm(), 1e-9);
      EXPECT_LT((there.normal - to.normal).norm(), 1e-12);
    }
  }
}

TEST(PatchAtlas, IsTheSameAtAnyThreadCount) {
  const SurfaceMesh mesh = build_surface_mesh(test::make_torus(2.0, 0.6, 40, 24, 0.5));
  set_thread_count(1);
  const PatchAtlas one = build_patch_atlas(mesh);
  set_thread_count(4);
  const PatchAtlas four = build_patch_atlas(mesh);
  set_thread_count(0);
  ASSERT_EQ(one.patch_count(), four.patch_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    ASSERT_EQ(one.patch_of(f), four.patch_of(f));
    for (int k = 0; k < 3; ++k) ASSERT_EQ(one.uv(f, k), four.uv(f, k));
  }
}

TEST(PatchAtlas, AnEmptyMeshHasNoCharts) {
  PolygonSoup soup;
  soup.source = "empty";
  const SurfaceMesh mesh = build_surface_mesh(soup);
  EXPECT_EQ(build_patch_atlas(mesh).patch_count(), 0u);
}

}  // namespace
}  // namespace vrc
