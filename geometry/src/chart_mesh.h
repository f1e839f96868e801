// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "face_graph.h"
#include "geometry/surface_mesh.h"

namespace vrc {

/// The faces of one chart as a mesh of their own, an oriented manifold with boundary. Corners share a
/// vertex where their faces are joined over an edge inside the chart. The faces are connected over
/// smooth edges; a crease that ends inside the chart does not slit it, because conformal maps overlap
/// at slits. Indices are local to the chart except for `source`.
struct ChartMesh {
  std::vector<std::uint32_t> source;  ///< Per face: its number in the SurfaceMesh.
  std::vector<Triangle> triangles;
  std::vector<std::array<std::uint32_t, 3>> neighbours;  ///< Across edge k, or kInvalidIndex.
  std::vector<std::array<bool, 3>> smooth;  ///< Whether edge k is inside the chart and no crease.
  std::vector<Vec3> positions;              ///< Per vertex, in world space.

  [[nodiscard]] std::size_t size() const { return triangles.size(); }
  [[nodiscard]] std::array<Vec3, 3> corners(std::size_t face) const {
    const auto& [a, b, c] = triangles[face];
    return {positions[a], positions[b], positions[c]};
  }
  /// Twice the area, times the normal.
  [[nodiscard]] Vec3 scaled_normal(std::size_t face) const {
    const auto [a, b, c] = corners(face);
    return (b - a).cross(c - a);
  }
  [[nodiscard]] bool has_boundary() const;
};

/// `local` is scratch space with an entry for every face of the mesh: only those of `faces` are
/// written, and only they are read, so charts can be made in parallel.
[[nodiscard]] ChartMesh make_chart_mesh(const SurfaceMesh& mesh, const FaceGraph& graph,
                                        std::span<const std::uint32_t> faces,
                                        std::span<const std::uint32_t> chart_of,
                                        std::vector<std::uint32_t>& local);

/// The connected parts that remain when the chart is cut between faces of different labels, numbered
/// by their smallest faces.
[[nodiscard]] std::vector<ChartMesh> cut_chart(const ChartMesh& chart, std::span<const std::uint32_t> label);

}  // namespace vrc
