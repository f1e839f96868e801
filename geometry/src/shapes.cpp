// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/shapes.h"

#include <array>
#include <cmath>
#include <unordered_map>

#include "core/error.h"

namespace vrc {
namespace {

using Corners = std::span<const std::uint32_t>;

void add_face(PolygonSoup& soup, Corners positions, Corners normals, Corners uvs) {
  soup.add_face(positions);
  soup.corner_normal.resize(soup.corner_position.size() - positions.size());
  soup.corner_normal.insert(soup.corner_normal.end(), normals.begin(), normals.end());
  if (uvs.empty()) return;
  soup.corner_uv.resize(soup.corner_position.size() - positions.size());
  soup.corner_uv.insert(soup.corner_uv.end(), uvs.begin(), uvs.end());
}

void require(const char* shape, bool condition, const char* problem) {
  if (!condition) throw InputError(shape, 0, problem);
}

// A quad whose corner uvs are the unit square; all corners share one normal.
void add_flat_quad(PolygonSoup& soup, const std::array<std::uint32_t, 4>& positions, const Vec3& normal) {
  const auto n = static_cast<std::uint32_t>(soup.normals.size());
  soup.normals.push_back(normal);
  if (soup.uvs.empty()) soup.uvs = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
  add_face(soup, positions, std::array{n, n, n, n}, std::array{0u, 1u, 2u, 3u});
}

// The lattice point i of n on a cube edge, at equal angles seen from the centre: the quads of the
// projected sphere then differ in area by less than a factor of 1.5 instead of 5.
double equiangular(int i, int n) {
  if (2 * i == n) return 0.0;
  return std::tan(kPi / 4.0 * (2.0 * i - n) / n);
}

// Hands out one vertex per lattice point of the cube's surface, so that the cube edges are welded.
class SphereVertices {
 public:
  SphereVertices(PolygonSoup& soup, const Vec3& center, double radius, int subdivision)
      : soup_(soup), center_(center), radius_(radius), n_(subdivision) {}

  std::uint32_t at(const std::array<int, 3>& lattice) {
    const std::int64_t side = n_ + 1;
    const std::int64_t key = (lattice[0] * side + lattice[1]) * side + lattice[2];
    const auto [entry, is_new] = indices_.try_emplace(key, static_cast<std::uint32_t>(soup_.normals.size()));
    if (is_new) {
      const Vec3 normal =
          Vec3(equiangular(lattice[0], n_), equiangular(lattice[1], n_), equiangular(lattice[2], n_))
              .normalized();
      soup_.normals.push_back(normal);
      soup_.positions.push_back(center_ + radius_ * normal);
    }
    return entry->second;
  }

 private:
  PolygonSoup& soup_;
  Vec3 center_;
  double radius_;
  int n_;
  std::unordered_map<std::int64_t, std::uint32_t> indices_;
};

}  // namespace

PolygonSoup make_rectangle() {
  PolygonSoup soup;
  soup.source = "rectangle";
  soup.positions = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};
  add_flat_quad(soup, {0, 1, 2, 3}, Vec3::UnitZ());
  return soup;
}

PolygonSoup make_cube() {
  PolygonSoup soup;
  soup.source = "cube";
  for (int i = 0; i < 8; ++i) {  // Bit k of i chooses the side along axis k.
    soup.positions.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  }
  add_flat_quad(soup, {0, 4, 6, 2}, -Vec3::UnitX());
  add_flat_quad(soup, {1, 3, 7, 5}, Vec3::UnitX());
  add_flat_quad(soup, {0, 1, 5, 4}, -Vec3::UnitY());
  add_flat_quad(soup, {2, 6, 7, 3}, Vec3::UnitY());
  add_flat_quad(soup, {0, 2, 3, 1}, -Vec3::UnitZ());
  add_flat_quad(soup, {4, 5, 7, 6}, Vec3::UnitZ());
  return soup;
}

PolygonSoup make_disk(int segments) {
  VRC_CHECK(segments >= 3, "a disk of {} segments", segments);
  PolygonSoup soup;
  soup.source = "disk";
  const auto n = static_cast<std::uint32_t>(segments);
  soup.normals = {Vec3::UnitZ()};
  soup.positions.emplace_back(0, 0, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double phi = 2.0 * kPi * i / n;
    soup.positions.emplace_back(std::cos(phi), std::sin(phi), 0);
  }
  // uv = (distance from the centre, angle / 2 pi). The angle runs to 1 at the seam; the centre has
  // no angle, so each triangle gives it that of its own middle.
  for (std::uint32_t i = 0; i <= n; ++i) soup.uvs.emplace_back(1.0, static_cast<double>(i) / n);
  for (std::uint32_t i = 0; i < n; ++i) soup.uvs.emplace_back(0.0, (i + 0.5) / n);
  for (std::uint32_t i = 0; i < n; ++i) {
    add_face(soup, std::array{0u, 1 + i, 1 + (i + 1) % n}, std::array{0u, 0u, 0u},
             std::array{n + 1 + i, i, i + 1});
  }
  return soup;
}

PolygonSoup make_cylinder(const Vec3& p0, const Vec3& p1, double radius, int segments) {
  VRC_CHECK(segments >= 3, "a cylinder of {} segments", segments);
  require("cylinder", radius > 0.0 && std::isfinite(radius), "the radius is not above 0; correct it");
  const Vec3 axis = p1 - p0;
  require("cylinder", axis.allFinite() && axis.stableNorm() > 0.0,
          "its two end points coincide or are not finite; move them apart");
  PolygonSoup soup;
  soup.source = "cylinder";
  const Vec3 w = axis.stableNormalized();
  const Vec3 u = w.unitOrthogonal();
  const Vec3 v = w.cross(u);
  const auto n = static_cast<std::uint32_t>(segments);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double phi = 2.0 * kPi * i / n;
    const Vec3 normal = (std::cos(phi) * u + std::sin(phi) * v).normalized();
    soup.normals.push_back(normal);
    soup.positions.push_back(p0 + radius * normal);
    soup.positions.push_back(p1 + radius * normal);
  }
  // uv = (angle / 2 pi, height / length); the angle runs to 1 at the seam.
  for (std::uint32_t i = 0; i <= n; ++i) {
    soup.uvs.emplace_back(static_cast<double>(i) / n, 0.0);
    soup.uvs.emplace_back(static_cast<double>(i) / n, 1.0);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    add_face(soup, std::array{2 * i, 2 * j, 2 * j + 1, 2 * i + 1}, std::array{i, j, j, i},
             std::array{2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  }
  return soup;
}

PolygonSoup make_sphere(const Vec3& center, double radius, int subdivision) {
  VRC_CHECK(subdivision >= 1, "a sphere of {} subdivisions", subdivision);
  require("sphere", radius > 0.0 && std::isfinite(radius), "the radius is not above 0; correct it");
  require("sphere", center.allFinite(), "the center is not finite; correct it");
  PolygonSoup soup;
  soup.source = "sphere";
  const int n = subdivision;
  SphereVertices vertices(soup, center, radius, n);
  // On the side of `axis`, the two next axes in cyclic order turn counter-clockwise seen from its
  // positive end; on the negative side they change roles.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      const std::size_t a = (axis + (side == n ? 1 : 2)) % 3;
      const std::size_t b = (axis + (side == n ? 2 : 1)) % 3;
      const auto vertex = [&](int i, int j) {
        std::array<int, 3> lattice{};
        lattice[axis] = side;
        lattice[a] = i;
        lattice[b] = j;
        return vertices.at(lattice);
      };
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const std::array quad{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)};
          add_face(soup, quad, quad, {});
        }
      }
    }
  }
  return soup;
}

}  // namespace vrc
