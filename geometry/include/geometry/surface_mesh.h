// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/creases.h"
#include "geometry/halfedge_mesh.h"
#include "geometry/mesh_repair.h"
#include "geometry/polygon_soup.h"

namespace vrc {

struct SurfaceMeshOptions {
  RepairOptions repair = {};
  CreaseOptions creases = {};
  /// Ignore supplied normals and shade flat: every edge that bends by more than 0.1 degree is a crease.
  bool face_normals = false;
};

/// An oriented manifold triangle mesh, perhaps with boundary, that knows where its surface is smooth.
///
/// Faces are in the order of their source polygons. Edge k of a face joins its corners k and
/// (k + 1) % 3. World space, double precision. Immutable; read from any number of threads.
class SurfaceMesh {
 public:
  /// Throws InputError where the soup is invalid; every other defect is repaired and reported.
  SurfaceMesh(const PolygonSoup& soup, const SurfaceMeshOptions& options);

  /// Connectivity and positions: handles are the indices used here.
  [[nodiscard]] const HalfedgeMesh& mesh() const { return mesh_; }
  [[nodiscard]] const MeshReport& report() const { return report_; }

  [[nodiscard]] std::size_t vertex_count() const { return mesh_.n_vertices(); }
  [[nodiscard]] std::size_t edge_count() const { return mesh_.n_edges(); }
  [[nodiscard]] std::size_t face_count() const { return triangles_.size(); }
  [[nodiscard]] std::size_t sector_count() const { return sector_normal_.size(); }
  [[nodiscard]] std::size_t region_count() const { return region_count_; }

  [[nodiscard]] const Triangle& triangle(std::size_t face) const { return triangles_[face]; }
  [[nodiscard]] Vec3 position(std::size_t vertex) const {
    return to_eigen(mesh_.point(OpenMesh::VertexHandle(static_cast<int>(vertex))));
  }
  [[nodiscard]] std::array<Vec3, 3> positions(std::size_t face) const {
    const auto& [a, b, c] = triangles_[face];
    return {position(a), position(b), position(c)};
  }
  /// Geometric, unit; its side is given by the corner order, counter-clockwise seen from it.
  [[nodiscard]] Vec3 face_normal(std::size_t face) const;
  [[nodiscard]] double face_area(std::size_t face) const;

  /// Unit shading normal: supplied, or the mean of the faces around the corner up to the creases.
  [[nodiscard]] const Vec3& corner_normal(std::size_t face, int k) const {
    return sector_normal_[corner_sector(face, k)];
  }
  /// Corners with the same sector share vertex and shading normal.
  [[nodiscard]] std::uint32_t corner_sector(std::size_t face, int k) const {
    return corner_sector_[3 * face + static_cast<std::size_t>(k)];
  }
  [[nodiscard]] const Vec3& sector_normal(std::size_t sector) const { return sector_normal_[sector]; }
  /// Whether the soup gave this sector's normal.
  [[nodiscard]] bool normal_is_supplied(std::size_t sector) const { return sector_supplied_[sector] != 0; }

  [[nodiscard]] bool has_uvs() const { return !corner_uv_.empty(); }
  /// (0, 0) where the soup gave none.
  [[nodiscard]] Vec2 corner_uv(std::size_t face, int k) const {
    return has_uvs() ? corner_uv_[3 * face + static_cast<std::size_t>(k)] : Vec2(Vec2::Zero());
  }

  [[nodiscard]] std::uint32_t material(std::size_t face) const { return material_[face]; }
  [[nodiscard]] std::uint32_t source_polygon(std::size_t face) const { return source_polygon_[face]; }
  /// Faces connected over smooth edges; numbered from 0 by their smallest faces.
  [[nodiscard]] std::uint32_t region(std::size_t face) const { return region_[face]; }

  [[nodiscard]] std::uint32_t edge(std::size_t face, int k) const {
    return static_cast<std::uint32_t>(mesh_.edge_handle(face_halfedge(mesh_, face, k)).idx());
  }
  /// The face across edge k, or kInvalidIndex at a boundary.
  [[nodiscard]] std::uint32_t neighbour(std::size_t face, int k) const;
  /// CreaseReason bits; 0 where the surface is smooth.
  [[nodiscard]] std::uint8_t crease(std::size_t edge) const { return creases_[edge]; }
  [[nodiscard]] std::span<const std::uint8_t> creases() const { return creases_; }

 private:
  void find_smooth_parts(const RepairedMesh& repaired, std::span<const Vec3> normals, const CreaseOptions&);

  HalfedgeMesh mesh_;
  MeshReport report_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> source_polygon_;
  std::vector<std::uint32_t> material_;
  std::vector<std::uint32_t> region_;
  std::size_t region_count_ = 0;
  std::vector<std::uint8_t> creases_;
  std::vector<std::uint32_t> corner_sector_;
  std::vector<Vec2> corner_uv_;
  std::vector<Vec3> sector_normal_;
  std::vector<std::uint8_t> sector_supplied_;
};

[[nodiscard]] SurfaceMesh build_surface_mesh(const PolygonSoup& soup, const SurfaceMeshOptions& options = {});

}  // namespace vrc
