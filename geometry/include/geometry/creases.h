// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/halfedge_mesh.h"

namespace vrc {

/// Why an edge is a crease: bits of one byte; 0 is a smooth edge.
enum CreaseReason : std::uint8_t {
  kCreaseBoundary = 1,     ///< One face only.
  kCreaseMaterial = 2,     ///< Separates two materials.
  kCreaseNonManifold = 4,  ///< Was non-manifold or cut by the repair.
  kCreaseAngle = 8,        ///< The faces' normals differ too much.
  kCreaseNormals = 16,     ///< The supplied normals differ across it.
};

struct CreaseOptions {
  double crease_angle = 40.0;  ///< Between the normals of the two faces. [degrees]
  /// Above this angle an edge is a crease even if the supplied normals agree. [degrees]
  double smooth_normals_angle = 90.0;
  double split_normals_angle = 1.0;  ///< Supplied normals that differ by more are split. [degrees]
};

/// What is known of the faces besides their shape. Corner k of face f has the entry 3 f + k, which for
/// edges means the edge from corner k to k + 1.
struct FaceAttributes {
  std::span<const std::uint32_t> material;      ///< Per face.
  std::span<const Vec3> supplied_normal;        ///< Per corner, unit, or zero where absent; may be empty.
  std::span<const std::uint8_t> detached_edge;  ///< Per corner.
};

/// Per edge of the mesh its CreaseReason bits. Where both faces of an edge have supplied normals at
/// its two ends, these decide (split, or smooth up to `smooth_normals_angle`); elsewhere the dihedral
/// angle does.
[[nodiscard]] std::vector<std::uint8_t> find_creases(const HalfedgeMesh& mesh, const FaceAttributes& faces,
                                                     const CreaseOptions& options = {});

/// Per face its smooth region: faces connected over smooth edges. Regions are numbered from 0 by their
/// smallest faces.
[[nodiscard]] std::vector<std::uint32_t> label_regions(const HalfedgeMesh& mesh,
                                                       std::span<const std::uint8_t> creases);

/// Per corner its sector: the corners around one vertex that are connected over smooth edges, which
/// share one shading normal. Sectors are numbered from 0 by their smallest corners.
[[nodiscard]] std::vector<std::uint32_t> label_sectors(const HalfedgeMesh& mesh,
                                                       std::span<const std::uint8_t> creases);

/// Per sector its unit shading normal: the mean of the supplied normals of its corners, or where there
/// are none the face normals weighted by the corners' angles.
[[nodiscard]] std::vector<Vec3> sector_normals(const HalfedgeMesh& mesh,
                                               std::span<const std::uint32_t> corner_sector,
                                               std::span<const Vec3> supplied_normal);

}  // namespace vrc
