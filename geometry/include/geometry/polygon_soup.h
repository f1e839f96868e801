// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace vrc {

/// Largest magnitude of a coordinate: Embree ignores triangles beyond about 1.8e18.
inline constexpr double kMaxCoordinate = 1e18;

/// Polygons as a file gives them, before any connectivity is built.
///
/// Invariants (`validate` checks them): every position is finite and at most `kMaxCoordinate` in
/// magnitude; normals are unit vectors; texture coordinates are finite; every index is in range;
/// every face has at least three corners. Faces may be concave, duplicated, degenerate or
/// inconsistently oriented: those are defects of the mesh, which `geometry/` repairs and reports.
struct PolygonSoup {
  std::string source;  ///< File or generator, for messages.

  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< Unit length; may be empty.
  std::vector<Vec2> uvs;      ///< May be empty.

  /// Face f has the corners [face_begin[f], face_begin[f + 1]); size is faces + 1 (or 0 when empty).
  std::vector<std::uint32_t> face_begin;
  std::vector<std::uint32_t> corner_position;
  std::vector<std::uint32_t> corner_normal;  ///< Empty, or per corner, `kInvalidIndex` where absent.
  std::vector<std::uint32_t> corner_uv;      ///< Empty, or per corner, `kInvalidIndex` where absent.
  std::vector<std::uint32_t> face_material;  ///< Empty (all 0), or per face.

  [[nodiscard]] std::size_t face_count() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> face_positions(std::size_t face) const {
    return std::span(corner_position).subspan(face_begin[face], face_begin[face + 1] - face_begin[face]);
  }
  /// Of the positions that faces use; empty when there is no face.
  [[nodiscard]] Box3 bounds() const;

  /// Appends a face with position indices only; keeps the optional per-corner arrays in step.
  void add_face(std::span<const std::uint32_t> position_indices);

  /// Throws InputError naming `source` when an invariant is broken.
  void validate() const;
};

/// Transforms positions by `to_world`, normals by its inverse transpose; a mirroring transform
/// reverses the corner order, so that faces keep their outside. Throws InputError naming `source`,
/// and leaves the soup as it was, when the matrix is not affine, not invertible or not finite, or
/// when a transformed coordinate exceeds `kMaxCoordinate`.
void transform(PolygonSoup& soup, const Mat4& to_world);

}  // namespace vrc
