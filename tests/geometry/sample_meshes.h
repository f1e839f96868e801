// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/shapes.h"
#include "support.h"

namespace vrc::test {

using FaceList = std::vector<std::vector<std::uint32_t>>;

inline PolygonSoup make_soup(std::vector<Vec3> positions, const FaceList& faces) {
  PolygonSoup soup;
  soup.source = "test";
  soup.positions = std::move(positions);
  for (const auto& face : faces) soup.add_face(face);
  return soup;
}

/// Appends `other`, all of whose corners must lack normals and uv.
inline void append(PolygonSoup& soup, const PolygonSoup& other, const Vec3& offset) {
  const auto base = static_cast<std::uint32_t>(soup.positions.size());
  for (const Vec3& p : other.positions) soup.positions.push_back(p + offset);
  for (std::size_t f = 0; f < other.face_count(); ++f) {
    std::vector<std::uint32_t> face;
    for (const std::uint32_t v : other.face_positions(f)) face.push_back(base + v);
    soup.add_face(face);
  }
}

inline PolygonSoup without_normals(PolygonSoup soup) {
  soup.normals.clear();
  soup.corner_normal.clear();
  return soup;
}

/// A grid of quads over (u, v) in [0, 1]^2, wrapped round in u and v where asked for; normals of
/// `normal` where it is given. Counter-clockwise in (u, v). `jitter` moves each grid point at random by
/// up to half that fraction of a cell, so that the triangles are irregular.
struct ParametricGrid {
  std::function<Vec3(double, double)> position;
  std::function<Vec3(double, double)> normal;
  int nu = 32;
  int nv = 32;
  bool wrap_u = false;
  bool wrap_v = false;
  double jitter = 0.0;
};

inline PolygonSoup make_grid(const ParametricGrid& grid) {
  PolygonSoup soup;
  soup.source = "grid";
  SeededBits random(1);
  const int columns = grid.wrap_u ? grid.nu : grid.nu + 1;
  const int rows = grid.wrap_v ? grid.nv : grid.nv + 1;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double u = (i + grid.jitter * (random.uniform() - 0.5)) / grid.nu;
      const double v = (j + grid.jitter * (random.uniform() - 0.5)) / grid.nv;
      soup.positions.push_back(grid.position(u, v));
      if (grid.normal) soup.normals.push_back(grid.normal(u, v));
    }
  }
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>((j % rows) * columns + i % columns);
  };
  for (int j = 0; j < grid.nv; ++j) {
    for (int i = 0; i < grid.nu; ++i) {
      soup.add_face(std::vector<std::uint32_t>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  if (grid.normal) soup.corner_normal = soup.corner_position;
  return soup;
}

inline Vec3 torus_normal(double u, double v) {
  const double a = 2.0 * kPi * u;
  const double b = 2.0 * kPi * v;
  return {std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)};
}

/// Normals out; u turns round the axis z, v round the tube.
inline PolygonSoup make_torus(double ring, double tube, int nu, int nv, double jitter = 0.0,
                              bool exact_normals = false) {
  ParametricGrid grid;
  grid.position = [=](double u, double v) {
    const double a = 2.0 * kPi * u;
    return Vec3(ring * Vec3(std::cos(a), std::sin(a), 0.0) + tube * torus_normal(u, v));
  };
  if (exact_normals) grid.normal = torus_normal;
  grid.nu = nu;
  grid.nv = nv;
  grid.wrap_u = grid.wrap_v = true;
  grid.jitter = jitter;
  return make_grid(grid);
}

/// z = height(x, y) over [-1, 1]^2, normals towards +z.
inline PolygonSoup make_height_field(const std::function<double(double, double)>& height, int n,
                                     double jitter = 0.0) {
  ParametricGrid grid;
  grid.position = [&height](double u, double v) {
    const double x = 2.0 * u - 1.0;
    const double y = 2.0 * v - 1.0;
    return Vec3(x, y, height(x, y));
  };
  grid.nu = grid.nv = n;
  grid.jitter = jitter;
  return make_grid(grid);
}

/// A band of `n` quads with half a twist.
inline PolygonSoup make_moebius_strip(int n) {
  std::vector<Vec3> positions;
  FaceList faces;
  for (int i = 0; i < n; ++i) {
    const double a = 2.0 * kPi * i / n;
    const Vec3 radial(std::cos(a), std::sin(a), 0.0);
    const Vec3 across = std::cos(0.5 * a) * radial + std::sin(0.5 * a) * Vec3::UnitZ();
    positions.push_back(radial - 0.3 * across);
    positions.push_back(radial + 0.3 * across);
  }
  const auto count = static_cast<std::uint32_t>(2 * n);
  for (std::uint32_t i = 0; i < count; i += 2) {
    const bool last = i + 2 == count;
    const std::uint32_t low = last ? 1 : i + 2;
    const std::uint32_t high = last ? 0 : i + 3;
    faces.push_back({i, low, high, i + 1});
  }
  return make_soup(std::move(positions), faces);
}

/// Regular tetrahedron, outward normals.
inline PolygonSoup make_tetrahedron() {
  return make_soup({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                   {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
}

/// Every shape and sample above, by name.
inline std::vector<std::pair<std::string, PolygonSoup>> all_sample_meshes() {
  PolygonSoup pair = make_tetrahedron();
  append(pair, make_tetrahedron(), Vec3(5, 0, 0));
  return {{"rectangle", make_rectangle()},
          {"cube", make_cube()},
          {"disk", make_disk(40)},
          {"cylinder", make_cylinder(Vec3(1, 2, 3), Vec3(2, 0, 4), 0.7, 30)},
          {"sphere", make_sphere(Vec3(1, 0, -1), 2.5, 8)},
          {"torus", make_torus(2.0, 0.6, 24, 16)},
          {"height field", make_height_field([](double x, double y) { return x * y; }, 9)},
          {"moebius strip", make_moebius_strip(12)},
          {"tetrahedron", make_tetrahedron()},
          {"two tetrahedra", pair}};
}

}  // namespace vrc::test
