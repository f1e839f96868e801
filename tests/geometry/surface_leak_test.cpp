// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets that lie close to each other in space and face the same way, where distances and normals say
// nothing, and walks that must not pass from one to the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "geometry/patch_atlas.h"
#include "geometry/region_index.h"
#include "geometry/surface_walker.h"
#include "sample_meshes.h"

namespace vrc {
namespace {

const Vec3 kCentre(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0);
constexpr double kReach = 0.5;
constexpr double kGap = 0.01 * kReach;  // Between sheets.

Vec3 center_of(const SurfaceMesh& mesh, std::size_t face) {
  const auto p = mesh.positions(face);
  return (p[0] + p[1] + p[2]) / 3.0;
}

SurfaceWalk walk_around(const SurfaceMesh& mesh, std::uint32_t face, double reach = kReach) {
  return walk_surface(mesh, make_ellipse(mesh, face, kCentre, Vec3(1.0, 0.3, 0.2), Vec2(reach, reach)));
}

// Three turns of a nearly plane ramp about the axis z, from radius 0.3 to 1.3.
PolygonSoup make_ramp(double jitter) {
  test::ParametricGrid grid;
  grid.position = [](double u, double v) {
    const double a = 6.0 * kPi * u;
    const double r = 0.3 + v;
    return Vec3(r * std::cos(a), r * std::sin(a), 3.0 * kGap * u);
  };
  grid.nu = 3 * 48;
  grid.nv = 8;
  grid.jitter = jitter;
  return test::make_grid(grid);
}

double turned(const Vec3& p) { return 2.0 * kPi * p.z() / kGap; }  // Angle on the ramp.

TEST(SurfaceLeak, ARampKeepsToItsTurn) {
  const SurfaceMesh mesh = build_surface_mesh(make_ramp(0.4));
  ASSERT_EQ(mesh.region_count(), 1u);
  for (std::uint32_t f = 3; f < mesh.face_count(); f += 41) {
    const Vec3 center = center_of(mesh, f);
    const double radius = center.head<2>().norm();
    if (radius < 0.7) continue;  // Further in, the ellipse reaches round the axis.
    const SurfaceWalk walk = walk_around(mesh, f);
    const double widest = std::asin(kReach / radius) + 0.25;  // And a face.
    for (const WalkedFace& walked : walk.faces) {
      const auto p = mesh.positions(walked.face);
      EXPECT_LT(std::abs(turned(center_of(mesh, walked.face)) - turned(center)), widest);
      for (std::size_t k = 0; k < 3; ++k) {
        const double seen_from_above = (p[k] - center).head<2>().norm();
        EXPECT_NEAR(walked.corners[k].norm(), seen_from_above, 1e-3);
      }
    }
  }
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

bool inside(const PatchAtlas& atlas, std::size_t face, const Vec2& uv) {
  for (int k = 0; k < 3; ++k) {
    const Vec2& a = atlas.uv(face, k);
    if (!(cross(atlas.uv(face, (k + 1) % 3) - a, uv - a) > 0.0)) return false;
  }
  return true;
}

TEST(SurfaceLeak, TurnsOfARampDoNotShareChartPlaces) {
  for (const double jitter : {0.0, 0.4}) {  // Without, the borders of the turns lie on each other.
    const SurfaceMesh mesh = build_surface_mesh(make_ramp(jitter));
    const PatchAtlas atlas = build_patch_atlas(mesh);
    EXPECT_GE(atlas.patch_count(), 3u);
    for (std::uint32_t f = 0; f < mesh.face_count(); f += 7) {
      const Vec2 uv = atlas.uv(f, kCentre);
      for (const std::uint32_t other : atlas.faces(atlas.patch_of(f)))
        EXPECT_EQ(inside(atlas, other, uv), other == f);
    }
  }
}

TEST(SurfaceLeak, RecordsOfARampAreFoundOnTheirTurnOnly) {
  const SurfaceMesh mesh = build_surface_mesh(make_ramp(0.4));
  const PatchAtlas atlas = build_patch_atlas(mesh);
  const std::uint32_t face = 1200;
  const SurfaceWalk walk = walk_around(mesh, face);
  const RegionIndex index(atlas.patch_count(), patch_footprints(atlas, walk, Vec2(kReach, kReach), 0));
  std::size_t stacked = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const Vec3 offset = center_of(mesh, f) - center_of(mesh, face);
    if (offset.norm() > 0.8 * kReach) continue;
    std::vector<std::uint32_t> records;
    index.covering({atlas.patch_of(f), atlas.uv(f, kCentre)}, records);
    const bool same_turn = std::abs(turned(center_of(mesh, f)) - turned(center_of(mesh, face))) < kPi;
    EXPECT_EQ(records.size(), same_turn ? 1u : 0u) << "face " << f;
    stacked += same_turn ? 0 : 1;
  }
  EXPECT_GT(stacked, 100u) << "faces above and below";
}

// An S of three sheets in x, extruded along y; `profile` gives (x, z) by the length of the curve.
constexpr double kSheet = 2.0;
constexpr double kBend = kPi * 0.5 * kGap;

Vec2 fold_profile(double s) {
  const double r = 0.5 * kGap;
  if (s < kSheet) return {s, 0.0};
  s -= kSheet;
  if (s < kBend) return {kSheet + r * std::sin(s / r), r - r * std::cos(s / r)};
  s -= kBend;
  if (s < kSheet) return {kSheet - s, kGap};
  s -= kSheet;
  if (s < kBend) return {-r * std::sin(s / r), kGap + r - r * std::cos(s / r)};
  return {s - kBend, 2.0 * kGap};
}

TEST(SurfaceLeak, AFoldIsUnfolded) {
  // Rows of quads along s, fine in the bends.
  std::vector<double> lengths;
  const auto add = [&](double from, double length, int n) {
    for (int i = 0; i < n; ++i) lengths.push_back(from + length * i / n);
  };
  add(0.0, kSheet, 20);
  add(kSheet, kBend, 12);
  add(kSheet + kBend, kSheet, 20);
  add(2.0 * kSheet + kBend, kBend, 12);
  add(2.0 * (kSheet + kBend), kSheet, 20);
  lengths.push_back(3.0 * kSheet + 2.0 * kBend);
  std::vector<double> chord(lengths.size(), 0.0);  // As the polygon is long.
  for (std::size_t i = 1; i < lengths.size(); ++i)
    chord[i] = chord[i - 1] + (fold_profile(lengths[i]) - fold_profile(lengths[i - 1])).norm();
  constexpr std::uint32_t kRows = 10;
  std::vector<Vec3> positions;
  test::FaceList faces;
  for (std::uint32_t i = 0; i < lengths.size(); ++i) {
    const Vec2 p = fold_profile(lengths[i]);
    for (std::uint32_t j = 0; j <= kRows; ++j) positions.emplace_back(p.x(), 0.2 * j, p.y());
  }
  for (std::uint32_t i = 0; i + 1 < lengths.size(); ++i) {
    for (std::uint32_t j = 0; j < kRows; ++j) {
      const std::uint32_t a = i * (kRows + 1) + j;
      faces.push_back({a, a + kRows + 1, a + kRows + 2, a + 1});
    }
  }
  const SurfaceMesh mesh = build_surface_mesh(test::make_soup(positions, faces));
  ASSERT_EQ(mesh.region_count(), 1u);
  const auto length_at = [&](std::uint32_t vertex) { return chord[vertex / (kRows + 1)]; };
  for (std::uint32_t f = 5; f < mesh.face_count(); f += 53) {
    const Triangle& own = mesh.triangle(f);
    const double s = (length_at(own[0]) + length_at(own[1]) + length_at(own[2])) / 3.0;
    for (const WalkedFace& walked : walk_around(mesh, f).faces) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangle(walked.face)[k];
        const double along = length_at(v) - s;
        const double across = mesh.position(v).y() - center_of(mesh, f).y();
        EXPECT_NEAR(walked.corners[k].norm(), std::hypot(along, across), 1e-9);
      }
    }
  }
}

TEST(SurfaceLeak, ASlitSeparatesUpToItsEnd) {
  // A plane, cut along x = y up to x = 0.6; the sides of the cut gape by 1e-4 but at its end.
  constexpr std::uint32_t kSide = 20;
  constexpr std::uint32_t kEnd = 16;
  std::vector<Vec3> positions;
  const auto at = [](std::uint32_t i, std::uint32_t j) { return j * (kSide + 1) + i; };
  for (std::uint32_t j = 0; j <= kSide; ++j)
    for (std::uint32_t i = 0; i <= kSide; ++i) positions.emplace_back(0.1 * i - 1.0, 0.1 * j - 1.0, 0.0);
  const auto second_side = static_cast<std::uint32_t>(positions.size());
  for (std::uint32_t i = 0; i < kEnd; ++i) positions.push_back(positions[at(i, i)] + Vec3(-7e-5, 7e-5, 0.0));
  const auto upper = [&](std::uint32_t i, std::uint32_t j) {
    return i == j && i < kEnd ? second_side + i : at(i, j);
  };
  test::FaceList faces;
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const bool above = j > i || (j == i);
      if (j == i) {
        faces.push_back({at(i, i), at(i + 1, i), at(i + 1, i + 1)});
        faces.push_back({upper(i, i), upper(i + 1, i + 1), upper(i, i + 1)});
      } else if (above) {
        faces.push_back({upper(i, j), upper(i + 1, j), upper(i + 1, j + 1), upper(i, j + 1)});
      } else {
        faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  const SurfaceMesh mesh = build_surface_mesh(test::make_soup(positions, faces));
  ASSERT_EQ(mesh.region_count(), 1u);
  const auto side_of = [&](std::size_t f) { return center_of(mesh, f).y() > center_of(mesh, f).x(); };
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (center_of(mesh, f).head<2>().maxCoeff() > -0.2) continue;
    for (const WalkedFace& walked : walk_around(mesh, f).faces) EXPECT_EQ(side_of(walked.face), side_of(f));
  }
}

TEST(SurfaceLeak, AThinWallHasTwoSides) {
  test::ParametricGrid side;
  side.nu = side.nv = 10;
  side.jitter = 0.4;
  side.position = [](double u, double v) { return Vec3(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0); };
  PolygonSoup soup = make_cube();  // Closed: joined by thin rims.
  for (Vec3& p : soup.positions) p.z() *= 0.5 * kGap;
  const SurfaceMesh closed = build_surface_mesh(soup);
  test::append(soup = test::make_grid(side), test::make_grid(side), Vec3(0.0, 0.0, kGap));
  const SurfaceMesh sheets = build_surface_mesh(soup);
  for (const SurfaceMesh* mesh : {&closed, &sheets}) {
    for (std::uint32_t f = 0; f < mesh->face_count(); f += 3) {
      for (const WalkedFace& walked : walk_around(*mesh, f, 4.0).faces)
        EXPECT_EQ(mesh->region(walked.face), mesh->region(f));
    }
  }
  EXPECT_EQ(closed.region_count(), 6u);
  EXPECT_EQ(sheets.region_count(), 2u);
}

TEST(SurfaceLeak, AnInsideCornerKeepsItsWallsApart) {
  PolygonSoup room = make_cube();
  for (std::size_t f = 0; f < room.face_count(); ++f) {
    std::reverse(room.corner_position.begin() + room.face_begin[f],
                 room.corner_position.begin() + room.face_begin[f + 1]);
  }
  room = test::without_normals(room);
  const SurfaceMesh mesh = build_surface_mesh(room);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const SurfaceWalk walk = walk_around(mesh, f, 10.0);
    EXPECT_EQ(walk.faces.size(), 2u);
    EXPECT_LT(walk.normal_deviation, 1e-7);
  }
}

TEST(SurfaceLeak, ACylinderIsUnrolledToItsGeodesics) {
  constexpr int kSegments = 64;
  const SurfaceMesh mesh = build_surface_mesh(make_cylinder(Vec3::Zero(), Vec3(0, 0, 2), 1.0, kSegments));
  for (std::uint32_t f = 0; f < mesh.face_count(); f += 11) {
    const Vec3 center = center_of(mesh, f);
    for (const WalkedFace& walked : walk_around(mesh, f, 0.8).faces) {
      const auto p = mesh.positions(walked.face);
      for (std::size_t k = 0; k < 3; ++k) {
        const double cosine = p[k].head<2>().normalized().dot(center.head<2>().normalized());
        const double geodesic = std::hypot(std::acos(std::clamp(cosine, -1.0, 1.0)), p[k].z() - center.z());
        EXPECT_NEAR(walked.corners[k].norm(), geodesic, 2e-3);
      }
    }
  }
}

}  // namespace
}  // namespace vrc
