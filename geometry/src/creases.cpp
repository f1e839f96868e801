// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/creases.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "disjoint_sets.h"

namespace vrc {
namespace {

std::array<Vec3, 3> corner_positions(const HalfedgeMesh& mesh, std::size_t face) {
  OpenMesh::HalfedgeHandle h = mesh.halfedge_handle(OpenMesh::FaceHandle(static_cast<int>(face)));
  std::array<Vec3, 3> p;
  for (Vec3& corner : p) {
    corner = to_eigen(mesh.point(mesh.to_vertex_handle(h)));
    h = mesh.next_halfedge_handle(h);
  }
  return p;
}

std::vector<Vec3> unit_face_normals(const HalfedgeMesh& mesh) {
  std::vector<Vec3> normals(mesh.n_faces());
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const auto [a, b, c] = corner_positions(mesh, f);
    normals[f] = (b - a).cross(c - a).normalized();
  }
  return normals;
}

double cos_degrees(double angle) { return std::cos(angle * kPi / 180.0); }

// The corners at the two ends of an edge, in its two faces.
struct EdgeCorners {
  std::size_t face[2];
  std::size_t start[2];  ///< Corner where the face's own half-edge starts, and
  std::size_t end[2];    ///< where it ends; start of one face is at the end of the other.
};

EdgeCorners edge_corners(const HalfedgeMesh& mesh, OpenMesh::EdgeHandle edge) {
  EdgeCorners corners{};
  for (unsigned side = 0; side < 2; ++side) {
    const OpenMesh::HalfedgeHandle h = mesh.halfedge_handle(edge, side);
    const auto f = static_cast<std::size_t>(mesh.face_handle(h).idx());
    const auto k = static_cast<std::size_t>(halfedge_corner(mesh, h));
    corners.face[side] = f;
    corners.start[side] = 3 * f + k;
    corners.end[side] = 3 * f + (k + 1) % 3;
  }
  return corners;
}

// Calls unite(corner a, corner b) or the like for every smooth edge.
template <typename Visit>
void for_smooth_edges(const HalfedgeMesh& mesh, std::span<const std::uint8_t> creases, const Visit& visit) {
  VRC_CHECK(creases.size() == mesh.n_edges(), "{} crease flags for {} edges", creases.size(), mesh.n_edges());
  for (std::size_t e = 0; e < creases.size(); ++e) {
    if (creases[e] == 0) visit(edge_corners(mesh, OpenMesh::EdgeHandle(static_cast<int>(e))));
  }
}

class CreaseFinder {
 public:
  CreaseFinder(const HalfedgeMesh& mesh, const FaceAttributes& faces, const CreaseOptions& options)
      : mesh_(mesh),
        faces_(faces),
        face_normals_(unit_face_normals(mesh)),
        cos_crease_(cos_degrees(options.crease_angle)),
        cos_smooth_(cos_degrees(options.smooth_normals_angle)),
        cos_split_(cos_degrees(options.split_normals_angle)) {}

  std::uint8_t reasons(OpenMesh::EdgeHandle edge) const {
    if (mesh_.is_boundary(edge)) return kCreaseBoundary | boundary_reasons(edge);
    const EdgeCorners c = edge_corners(mesh_, edge);
    unsigned bits = 0;
    if (faces_.material[c.face[0]] != faces_.material[c.face[1]]) bits |= kCreaseMaterial;
    if (faces_.detached_edge[c.start[0]] != 0 || faces_.detached_edge[c.start[1]] != 0) {
      bits |= kCreaseNonManifold;
    }
    const bool supplied =
        has_normal(c.start[0]) && has_normal(c.end[0]) && has_normal(c.start[1]) && has_normal(c.end[1]);
    if (supplied && (split(c.start[0], c.end[1]) || split(c.end[0], c.start[1]))) bits |= kCreaseNormals;
    const double cos_dihedral = face_normals_[c.face[0]].dot(face_normals_[c.face[1]]);
    if (cos_dihedral < (supplied ? cos_smooth_ : cos_crease_)) bits |= kCreaseAngle;
    return static_cast<std::uint8_t>(bits);
  }

 private:
  std::uint8_t boundary_reasons(OpenMesh::EdgeHandle edge) const {
    for (unsigned side = 0; side < 2; ++side) {
      const OpenMesh::HalfedgeHandle h = mesh_.halfedge_handle(edge, side);
      if (mesh_.is_boundary(h)) continue;
      const auto f = static_cast<std::size_t>(mesh_.face_handle(h).idx());
      const auto k = static_cast<std::size_t>(halfedge_corner(mesh_, h));
      if (faces_.detached_edge[3 * f + k] != 0) return kCreaseNonManifold;
    }
    return 0;
  }

  bool has_normal(std::size_t corner) const {
    return !faces_.supplied_normal.empty() && faces_.supplied_normal[corner] != Vec3::Zero();
  }

  bool split(std::size_t a, std::size_t b) const {
    return faces_.supplied_normal[a].dot(faces_.supplied_normal[b]) < cos_split_;
  }

  const HalfedgeMesh& mesh_;
  const FaceAttributes& faces_;
  std::vector<Vec3> face_normals_;
  double cos_crease_;
  double cos_smooth_;
  double cos_split_;
};

// The interior angle at corner k, by atan2: exact enough for slivers.
double corner_angle(const std::array<Vec3, 3>& p, std::size_t k) {
  const Vec3 u = p[(k + 1) % 3] - p[k];
  const Vec3 v = p[(k + 2) % 3] - p[k];
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

std::vector<std::uint8_t> find_creases(const HalfedgeMesh& mesh, const FaceAttributes& faces,
                                       const CreaseOptions& options) {
  VRC_CHECK(faces.material.size() == mesh.n_faces(), "{} materials", faces.material.size());
  VRC_CHECK(faces.detached_edge.size() == 3 * mesh.n_faces(), "{} flags", faces.detached_edge.size());
  const CreaseFinder finder(mesh, faces, options);
  std::vector<std::uint8_t> creases(mesh.n_edges());
  for (std::size_t e = 0; e < creases.size(); ++e) {
    creases[e] = finder.reasons(OpenMesh::EdgeHandle(static_cast<int>(e)));
  }
  return creases;
}

std::vector<std::uint32_t> label_regions(const HalfedgeMesh& mesh, std::span<const std::uint8_t> creases) {
  DisjointSets regions(mesh.n_faces());
  for_smooth_edges(mesh, creases, [&regions](const EdgeCorners& edge) {
    regions.unite(static_cast<std::uint32_t>(edge.face[0]), static_cast<std::uint32_t>(edge.face[1]));
  });
  return regions.labels();
}

std::vector<std::uint32_t> label_sectors(const HalfedgeMesh& mesh, std::span<const std::uint8_t> creases) {
  DisjointSets sectors(3 * mesh.n_faces());
  for_smooth_edges(mesh, creases, [&sectors](const EdgeCorners& edge) {
    sectors.unite(static_cast<std::uint32_t>(edge.start[0]), static_cast<std::uint32_t>(edge.end[1]));
    sectors.unite(static_cast<std::uint32_t>(edge.end[0]), static_cast<std::uint32_t>(edge.start[1]));
  });
  return sectors.labels();
}

std::vector<Vec3> sector_normals(const HalfedgeMesh& mesh, std::span<const std::uint32_t> corner_sector,
                                 std::span<const Vec3> supplied_normal) {
  const std::uint32_t sectors =
      corner_sector.empty() ? 0 : *std::max_element(corner_sector.begin(), corner_sector.end()) + 1;
  std::vector<Vec3> supplied(sectors, Vec3::Zero());
  std::vector<Vec3> weighted(sectors, Vec3::Zero());
  std::vector<Vec3> any_face(sectors);
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<Vec3, 3> p = corner_positions(mesh, f);
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t sector = corner_sector[3 * f + k];
      if (!supplied_normal.empty()) supplied[sector] += supplied_normal[3 * f + k];
      weighted[sector] += corner_angle(p, k) * normal;
      any_face[sector] = normal;
    }
  }
  // Opposite normals may cancel (a fold, or broken input); then the next best source is taken.
  constexpr double kCancelled = 1e-6;
  for (std::uint32_t s = 0; s < sectors; ++s) {
    if (supplied[s].norm() > kCancelled) {
      supplied[s].normalize();
    } else {
      supplied[s] = weighted[s].norm() > kCancelled ? weighted[s].normalized() : any_face[s];
    }
  }
  return supplied;
}

}  // namespace vrc
