// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_lscm.h"

#include <CGAL/Eigen_solver_traits.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/LSCM_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Two_vertices_parameterizer_3.h>

#include <Eigen/SparseCholesky>

namespace vrc {
namespace {

namespace smp = CGAL::Surface_mesh_parameterization;
using Kernel = CGAL::Simple_cartesian<double>;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Border = smp::Two_vertices_parameterizer_3<CgalMesh>;
using Solver =
    CGAL::Eigen_solver_traits<Eigen::SimplicialLDLT<CGAL::Eigen_sparse_symmetric_matrix<double>::EigenType>>;
using Parameterizer = smp::LSCM_parameterizer_3<CgalMesh, Border, Solver>;

// Vertices keep their numbers and are given relative to the first. Nothing when a face is refused.
std::optional<CgalMesh> to_cgal(const ChartMesh& chart) {
  CgalMesh mesh;
  const auto vertices = static_cast<CgalMesh::size_type>(chart.positions.size());
  const auto faces = static_cast<CgalMesh::size_type>(chart.size());
  mesh.reserve(vertices, 2 * faces, faces);
  for (const Vec3& p : chart.positions) {
    const Vec3 d = p - chart.positions.front();
    mesh.add_vertex({d.x(), d.y(), d.z()});
  }
  for (const auto& [a, b, c] : chart.triangles) {
    const CgalMesh::Face_index face =
        mesh.add_face(CgalMesh::Vertex_index(a), CgalMesh::Vertex_index(b), CgalMesh::Vertex_index(c));
    if (face == CgalMesh::null_face()) return std::nullopt;
  }
  return mesh;
}

// A half-edge of the longest boundary loop, where the pinned vertices are far apart.
CgalMesh::Halfedge_index longest_border(const CgalMesh& mesh) {
  std::vector<char> seen(mesh.num_halfedges(), 0);
  CgalMesh::Halfedge_index best = CgalMesh::null_halfedge();
  double longest = -1.0;
  for (const CgalMesh::Halfedge_index begin : mesh.halfedges()) {
    if (!mesh.is_border(begin) || seen[begin] != 0) continue;
    double length = 0.0;
    for (CgalMesh::Halfedge_index h = begin; seen[h] == 0; h = mesh.next(h)) {
      seen[h] = 1;
      const Kernel::Vector_3 e = mesh.point(mesh.target(h)) - mesh.point(mesh.source(h));
      length += std::sqrt(e.squared_length());
    }
    if (length > longest) {
      longest = length;
      best = begin;
    }
  }
  return best;
}

}  // namespace

std::optional<std::vector<Vec2>> conformal_map(const ChartMesh& chart) {
  std::optional<CgalMesh> mesh = to_cgal(chart);
  if (!mesh) return std::nullopt;
  const CgalMesh::Halfedge_index border = longest_border(*mesh);
  if (border == CgalMesh::null_halfedge()) return std::nullopt;
  using Vertex = CgalMesh::Vertex_index;
  const auto uv = mesh->add_property_map<Vertex, Kernel::Point_2>("v:uv", {0.0, 0.0}).first;
  const auto index = mesh->add_property_map<Vertex, int>("v:index", 0).first;
  const auto pinned = mesh->add_property_map<Vertex, bool>("v:pinned", false).first;
  for (const Vertex v : mesh->vertices()) index[v] = static_cast<int>(v.idx());
  if (Parameterizer().parameterize(*mesh, border, uv, index, pinned) != smp::OK) return std::nullopt;
  std::vector<Vec2> result;
  result.reserve(chart.positions.size());
  for (const Vertex v : mesh->vertices()) result.emplace_back(uv[v].x(), uv[v].y());
  return result;
}

}  // namespace vrc
