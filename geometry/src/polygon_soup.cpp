// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/polygon_soup.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace vrc {
namespace {

// Normals are normalised in double precision; anything further from 1 was never normalised.
constexpr double kUnitTolerance = 1e-6;

void check(const PolygonSoup& soup, bool condition, const char* problem) {
  if (!condition) throw InputError(soup.source, 0, problem);
}

template <typename... Args>
[[noreturn]] void fail(const PolygonSoup& soup, fmt::format_string<Args...> problem, Args&&... args) {
  throw InputError(soup.source, 0, fmt::format(problem, std::forward<Args>(args)...));
}

bool is_usable_position(const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= kMaxCoordinate; }

void validate_values(const PolygonSoup& soup) {
  for (std::size_t i = 0; i < soup.positions.size(); ++i) {
    if (!is_usable_position(soup.positions[i])) {
      fail(soup, "position {} is not finite or above 1e18; repair the mesh", i);
    }
  }
  for (std::size_t i = 0; i < soup.normals.size(); ++i) {
    if (!(std::abs(soup.normals[i].norm() - 1.0) <= kUnitTolerance)) {
      fail(soup, "normal {} is not a unit vector; normalise the normals", i);
    }
  }
  for (std::size_t i = 0; i < soup.uvs.size(); ++i) {
    if (!soup.uvs[i].allFinite()) {
      fail(soup, "texture coordinate {} is not finite; repair the mesh", i);
    }
  }
}

void validate_faces(const PolygonSoup& soup) {
  const auto& begin = soup.face_begin;
  check(soup, begin.empty() || begin.front() == 0, "the first face does not begin at corner 0");
  check(soup, (begin.empty() ? 0 : begin.back()) == soup.corner_position.size(),
        "the faces do not cover all corners");
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    if (begin[face + 1] < begin[face] || begin[face + 1] - begin[face] < 3) {
      fail(soup, "face {} has fewer than three corners; remove it", face);
    }
  }
  check(soup, soup.face_material.empty() || soup.face_material.size() == soup.face_count(),
        "the number of face materials differs from the number of faces");
}

// Corner indices below `count`; `kInvalidIndex` only where a corner may lack the attribute.
void validate_corners(const PolygonSoup& soup, const std::vector<std::uint32_t>& corners, std::size_t count,
                      bool may_be_absent, const char* name) {
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    const std::uint32_t index = corners[corner];
    if (index < count || (may_be_absent && index == kInvalidIndex)) continue;
    fail(soup, "corner {} refers to {} {}, but there are {}; repair the mesh", corner, name, index, count);
  }
}

}  // namespace

Box3 PolygonSoup::bounds() const {
  Box3 box;
  for (const std::uint32_t index : corner_position) box.extend(positions[index]);
  return box;
}

void PolygonSoup::add_face(std::span<const std::uint32_t> position_indices) {
  VRC_CHECK(corner_position.size() + position_indices.size() < kInvalidIndex,
            "{}: more corners than 32-bit indices can count", source);
  const bool has_normals = !corner_normal.empty();
  const bool has_uvs = !corner_uv.empty();
  if (face_begin.empty()) face_begin.push_back(0);
  corner_position.insert(corner_position.end(), position_indices.begin(), position_indices.end());
  if (has_normals) corner_normal.resize(corner_position.size(), kInvalidIndex);
  if (has_uvs) corner_uv.resize(corner_position.size(), kInvalidIndex);
  if (!face_material.empty()) face_material.push_back(0);
  face_begin.push_back(static_cast<std::uint32_t>(corner_position.size()));
}

void PolygonSoup::validate() const {
  validate_values(*this);
  validate_faces(*this);
  check(*this, corner_normal.empty() || corner_normal.size() == corner_position.size(),
        "the number of corner normals differs from the number of corners");
  check(*this, corner_uv.empty() || corner_uv.size() == corner_position.size(),
        "the number of corner texture coordinates differs from the number of corners");
  validate_corners(*this, corner_position, positions.size(), false, "position");
  validate_corners(*this, corner_normal, normals.size(), true, "normal");
  validate_corners(*this, corner_uv, uvs.size(), true, "texture coordinate");
}

void transform(PolygonSoup& soup, const Mat4& to_world) {
  check(soup, to_world.allFinite(), "the to_world matrix is not finite; correct the transform");
  check(soup, to_world.row(3) == Eigen::RowVector4d(0, 0, 0, 1),
        "the last row of the to_world matrix is not 0 0 0 1; only affine transforms move a shape");
  const Mat3 linear = to_world.topLeftCorner<3, 3>();
  const Vec3 offset = to_world.topRightCorner<3, 1>();
  // Scaled, so that the determinant of a tiny or huge matrix keeps its sign.
  const double scale = linear.cwiseAbs().maxCoeff();
  const Eigen::FullPivLU<Mat3> lu(scale > 0.0 ? Mat3(linear / scale) : linear);
  check(soup, lu.isInvertible(), "the to_world matrix flattens the shape; give each axis a scale above 0");

  std::vector<Vec3> moved(soup.positions.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    moved[i] = linear * soup.positions[i] + offset;
    check(soup, is_usable_position(moved[i]), "to_world moves a vertex beyond 1e18; use smaller units");
  }
  soup.positions = std::move(moved);

  const Mat3 normal_to_world = lu.inverse().transpose();
  for (Vec3& normal : soup.normals) normal = (normal_to_world * normal).stableNormalized();

  if (lu.determinant() > 0.0) return;
  const auto reverse_corners = [](std::vector<std::uint32_t>& corners, std::size_t first, std::size_t last) {
    if (!corners.empty()) {
      std::reverse(corners.begin() + static_cast<std::ptrdiff_t>(first),
                   corners.begin() + static_cast<std::ptrdiff_t>(last));
    }
  };
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    const std::size_t second = soup.face_begin[face] + 1u;  // The first corner stays the first.
    const std::size_t last = soup.face_begin[face + 1];
    reverse_corners(soup.corner_position, second, last);
    reverse_corners(soup.corner_normal, second, last);
    reverse_corners(soup.corner_uv, second, last);
  }
}

}  // namespace vrc
