// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <OpenMesh/Core/Mesh/Traits.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cstdint>

#include "core/types.h"

namespace vrc {

/// Connectivity and double-precision positions; everything else lives in flat arrays beside it.
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

[[nodiscard]] inline Vec3 to_eigen(const OpenMesh::Vec3d& v) { return {v[0], v[1], v[2]}; }
[[nodiscard]] inline OpenMesh::Vec3d to_openmesh(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Half-edge from corner k of a face to corner (k + 1) % 3. The corners keep the order in which the
/// face was added, and OpenMesh anchors a new face at its last edge.
[[nodiscard]] inline OpenMesh::HalfedgeHandle face_halfedge(const HalfedgeMesh& mesh, std::size_t face,
                                                            int k) {
  OpenMesh::HalfedgeHandle h = mesh.halfedge_handle(OpenMesh::FaceHandle(static_cast<int>(face)));
  for (int i = 0; i <= k; ++i) h = mesh.next_halfedge_handle(h);
  return h;
}

/// The k for which `h` is face_halfedge(mesh, face of h, k); `h` must not be a boundary half-edge.
[[nodiscard]] inline int halfedge_corner(const HalfedgeMesh& mesh, OpenMesh::HalfedgeHandle h) {
  const OpenMesh::HalfedgeHandle last = mesh.halfedge_handle(mesh.face_handle(h));
  if (h == last) return 2;
  return mesh.next_halfedge_handle(h) == last ? 1 : 0;
}

}  // namespace vrc
