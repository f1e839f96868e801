// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/types.h"
#include "geometry/polygon_soup.h"
#include "geometry/triangulate.h"

namespace vrc {

/// Defects found and how the repaired mesh came out. Defects are data, never errors.
struct MeshReport {
  // What was found in the polygons.
  std::size_t welded_vertices = 0;        ///< Positions merged into an earlier one.
  std::size_t isolated_vertices = 0;      ///< Distinct positions that no kept face uses; left out.
  std::size_t triangulated_polygons = 0;  ///< Polygons with more than three corners.
  std::size_t degenerate_faces = 0;       ///< Polygons or pieces of them without area; left out.
  std::size_t duplicate_faces = 0;        ///< Polygons repeating another one, either way round; left out.
  std::size_t non_manifold_edges = 0;     ///< Edges of three or more triangles; all are detached there.
  std::size_t non_manifold_vertices = 0;  ///< Points (not on such an edge) where several fans meet.
  std::size_t orientation_cuts = 0;       ///< Edges opened because no orientation fits (Möbius strips).
  std::size_t flipped_faces = 0;          ///< Triangles whose corner order was reversed.
  std::size_t vertex_copies = 0;          ///< Vertices added by detaching.

  // The result.
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t faces = 0;  ///< Triangles.
  std::size_t boundary_edges = 0;
  std::size_t boundary_loops = 0;  ///< Holes, and the rims of open surfaces.
  std::size_t components = 0;      ///< Connected over edges.
  std::size_t genus = 0;           ///< Handles, summed over the components.
  bool watertight = false;         ///< There are faces and no boundary.
  double area = 0.0;               ///< [world units squared]
  Box3 bounds;                     ///< Of the vertices kept; empty without faces.
};

struct RepairOptions {
  /// Positions closer than this fraction of the bounding box's diagonal are merged; 0 merges only
  /// equal coordinates.
  double weld_tolerance = 0.0;
  /// Turns every component without boundary so that its normals point out of it. Otherwise each
  /// component keeps the orientation that most of its triangles have in the file.
  bool orient_outward = false;
};

/// Oriented triangles in which every edge has one or two faces and every vertex one fan, so that a
/// half-edge structure takes them all. Triangles are in the order of their source polygons; vertices
/// in the order of the soup's positions, copies last.
///
/// Edge k of a triangle joins its corners k and (k + 1) % 3. "Corner" arrays hold 3 entries a triangle.
struct RepairedMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> source_polygon;  ///< Per triangle: face of the soup.
  std::vector<std::uint32_t> source_corner;   ///< Per corner: index into the soup's corner arrays.
  std::vector<std::uint8_t> flipped;          ///< Per triangle: 1 where the corner order was reversed.
  std::vector<std::uint8_t> detached_edge;    ///< Per corner k: 1 where edge k was non-manifold or cut.
  MeshReport report;                          ///< The first group only.
};

/// Welds, drops degenerate and duplicate faces, triangulates, orients and detaches. The soup must be
/// valid (`PolygonSoup::validate`). No area is lost: whatever is left out has none of its own.
[[nodiscard]] RepairedMesh repair_mesh(const PolygonSoup& soup, const RepairOptions& options = {});

}  // namespace vrc
