// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_mesh.h"

#include <algorithm>

#include "core/error.h"
#include "disjoint_sets.h"

namespace vrc {
namespace {

// Flat shading: triangles of one plane still belong together.
constexpr double kFlatAngle = 0.1;  // [degrees]

HalfedgeMesh build_halfedges(const RepairedMesh& repaired) {
  HalfedgeMesh mesh;
  mesh.reserve(repaired.positions.size(), 2 * repaired.triangles.size(), repaired.triangles.size());
  for (const Vec3& p : repaired.positions) mesh.add_vertex(to_openmesh(p));
  std::vector<OpenMesh::VertexHandle> corners(3);
  for (std::size_t f = 0; f < repaired.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = OpenMesh::VertexHandle(static_cast<int>(repaired.triangles[f][k]));
    }
    const OpenMesh::FaceHandle added = mesh.add_face(corners);
    VRC_CHECK(added.is_valid() && added.idx() == static_cast<int>(f), "face {} of {} was refused", f,
              repaired.triangles.size());
  }
  return mesh;
}

std::vector<std::uint32_t> face_materials(const PolygonSoup& soup, const RepairedMesh& repaired) {
  std::vector<std::uint32_t> materials(repaired.triangles.size(), 0);
  if (soup.face_material.empty()) return materials;
  for (std::size_t f = 0; f < materials.size(); ++f) {
    materials[f] = soup.face_material[repaired.source_polygon[f]];
  }
  return materials;
}

std::vector<Vec2> corner_uvs(const PolygonSoup& soup, const RepairedMesh& repaired) {
  if (soup.uvs.empty() || soup.corner_uv.empty()) return {};
  std::vector<Vec2> uvs(repaired.source_corner.size(), Vec2::Zero());
  for (std::size_t c = 0; c < uvs.size(); ++c) {
    const std::uint32_t uv = soup.corner_uv[repaired.source_corner[c]];
    if (uv != kInvalidIndex) uvs[c] = soup.uvs[uv];
  }
  return uvs;
}

// Per face the number of its component, counted from 0.
std::vector<std::uint32_t> face_components(const HalfedgeMesh& mesh) {
  DisjointSets sets(mesh.n_faces());
  for (const OpenMesh::SmartEdgeHandle edge : mesh.edges()) {
    if (edge.is_boundary()) continue;
    sets.unite(static_cast<std::uint32_t>(edge.h0().face().idx()),
               static_cast<std::uint32_t>(edge.h1().face().idx()));
  }
  return sets.labels();
}

std::size_t label_count(std::span<const std::uint32_t> labels) {
  return labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end()) + std::size_t{1};
}

Vec3 scaled_normal(const RepairedMesh& mesh, std::size_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  return (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
}

// Per corner the soup's normal; zero where there is none.
std::vector<Vec3> read_normals(const PolygonSoup& soup, const RepairedMesh& repaired) {
  if (soup.normals.empty() || soup.corner_normal.empty()) return {};
  std::vector<Vec3> normals(repaired.source_corner.size(), Vec3::Zero());
  for (std::size_t c = 0; c < normals.size(); ++c) {
    const std::uint32_t n = soup.corner_normal[repaired.source_corner[c]];
    if (n != kInvalidIndex) normals[c] = soup.normals[n];
  }
  return normals;
}

// Supplied normals follow the orientation of the faces, not the other way round: each component's
// normals are reversed together when most of its area disagrees with them, and then those of the
// triangles that the repair reversed. A sliver whose own normal is noise thus keeps what it was given.
void match_orientation(const RepairedMesh& repaired, const HalfedgeMesh& mesh, std::vector<Vec3>& normals) {
  const auto agreement = [&](std::size_t f) {
    return scaled_normal(repaired, f).dot(normals[3 * f] + normals[3 * f + 1] + normals[3 * f + 2]);
  };
  const auto reverse = [&](std::size_t f) {
    for (std::size_t c = 3 * f; c < 3 * f + 3; ++c) normals[c] = -normals[c];
  };
  const std::vector<std::uint32_t> component = face_components(mesh);
  std::vector<double> vote(repaired.triangles.size(), 0.0);
  for (std::size_t f = 0; f < component.size(); ++f) vote[component[f]] += agreement(f);
  for (std::size_t f = 0; f < component.size(); ++f) {
    if (vote[component[f]] < 0.0) reverse(f);
    if (repaired.flipped[f] != 0 && agreement(f) < 0.0) reverse(f);
  }
}

std::size_t count_boundary_loops(const HalfedgeMesh& mesh) {
  std::vector<std::uint8_t> seen(mesh.n_halfedges(), 0);
  std::size_t loops = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    OpenMesh::HalfedgeHandle h(static_cast<int>(i));
    if (seen[i] != 0 || !mesh.is_boundary(h)) continue;
    ++loops;
    for (; seen[static_cast<std::size_t>(h.idx())] == 0; h = mesh.next_halfedge_handle(h)) {
      seen[static_cast<std::size_t>(h.idx())] = 1;
    }
  }
  return loops;
}

MeshReport describe_result(const RepairedMesh& repaired, const HalfedgeMesh& mesh) {
  MeshReport report = repaired.report;
  report.vertices = mesh.n_vertices();
  report.edges = mesh.n_edges();
  report.faces = mesh.n_faces();
  for (const OpenMesh::SmartEdgeHandle edge : mesh.edges())
    report.boundary_edges += edge.is_boundary() ? 1 : 0;
  report.boundary_loops = count_boundary_loops(mesh);
  report.components = label_count(face_components(mesh));
  // Euler: V - E + F = 2 C - 2 g - b for C orientable components with g handles and b boundary loops.
  const std::size_t twice_genus =
      2 * report.components + report.edges - report.boundary_loops - report.vertices - report.faces;
  VRC_CHECK(twice_genus % 2 == 0, "twice the genus is {}", twice_genus);
  report.genus = twice_genus / 2;
  report.watertight = report.faces > 0 && report.boundary_edges == 0;
  for (std::size_t f = 0; f < report.faces; ++f) report.area += 0.5 * scaled_normal(repaired, f).norm();
  for (const Vec3& p : repaired.positions) report.bounds.extend(p);
  return report;
}

}  // namespace

SurfaceMesh::SurfaceMesh(const PolygonSoup& soup, const SurfaceMeshOptions& options) {
  soup.validate();
  RepairedMesh repaired = repair_mesh(soup, options.repair);
  mesh_ = build_halfedges(repaired);
  report_ = describe_result(repaired, mesh_);
  material_ = face_materials(soup, repaired);
  corner_uv_ = corner_uvs(soup, repaired);

  std::vector<Vec3> normals;
  CreaseOptions creases = options.creases;
  if (options.face_normals) {
    creases.crease_angle = kFlatAngle;
  } else {
    normals = read_normals(soup, repaired);
    if (!normals.empty()) match_orientation(repaired, mesh_, normals);
  }
  find_smooth_parts(repaired, normals, creases);
  triangles_ = std::move(repaired.triangles);
  source_polygon_ = std::move(repaired.source_polygon);
}

void SurfaceMesh::find_smooth_parts(const RepairedMesh& repaired, std::span<const Vec3> normals,
                                    const CreaseOptions& options) {
  creases_ = find_creases(mesh_, {material_, normals, repaired.detached_edge}, options);
  region_ = label_regions(mesh_, creases_);
  region_count_ = label_count(region_);
  corner_sector_ = label_sectors(mesh_, creases_);
  sector_normal_ = sector_normals(mesh_, corner_sector_, normals);
  sector_supplied_.assign(sector_normal_.size(), 0);
  for (std::size_t c = 0; c < normals.size(); ++c) {
    if (normals[c] != Vec3::Zero()) sector_supplied_[corner_sector_[c]] = 1;
  }
}

Vec3 SurfaceMesh::face_normal(std::size_t face) const {
  const auto [a, b, c] = positions(face);
  return (b - a).cross(c - a).normalized();
}

double SurfaceMesh::face_area(std::size_t face) const {
  const auto [a, b, c] = positions(face);
  return 0.5 * (b - a).cross(c - a).norm();
}

std::uint32_t SurfaceMesh::neighbour(std::size_t face, int k) const {
  const OpenMesh::HalfedgeHandle across = mesh_.opposite_halfedge_handle(face_halfedge(mesh_, face, k));
  return mesh_.is_boundary(across) ? kInvalidIndex
                                   : static_cast<std::uint32_t>(mesh_.face_handle(across).idx());
}

SurfaceMesh build_surface_mesh(const PolygonSoup& soup, const SurfaceMeshOptions& options) {
  return {soup, options};
}

}  // namespace vrc
