// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/types.h"
#include "geometry/surface_mesh.h"

namespace vrc {

enum class CurvatureMethod : std::uint8_t {
  kFaceTensors,  ///< Differences of the shading normals over each face [Rusinkiewicz2004].
  kJet,          ///< Polynomial fits to the positions around each sector [Cazals2005].
};

struct CurvatureOptions {
  CurvatureMethod method = CurvatureMethod::kFaceTensors;
  /// kFaceTensors: averages over neighbours; sectors with supplied normals are never averaged.
  int smoothing_passes = 1;
  /// kJet: degree of the fitted height function, 2 to 4, and how many rings of faces it is fitted to.
  int jet_degree = 4;
  int jet_rings = 3;
};

/// Eigenvalues of a shape operator, k1 >= k2 (signed) [1 / world unit], and their unit directions in
/// the tangent plane; (direction1, direction2, normal) is right-handed.
struct PrincipalCurvatures {
  double k1 = 0.0;
  double k2 = 0.0;
  Vec3 direction1 = Vec3::Zero();
  Vec3 direction2 = Vec3::Zero();
};

/// The shape operator of the shaded surface at every point of a mesh, pointwise (not integrated).
///
/// S = dn/dx: a step d in the tangent plane turns the unit shading normal to normalize(n + S d).
/// With outward normals S is positive on convex objects: I / r on a sphere of radius r. It is given as
/// a symmetric world-space 3x3 tensor [1 / world unit] whose null space holds n. Sectors keep S apart
/// across creases, so a cube is flat up to its edges.
///
/// Refers to the mesh it was estimated on, which must outlive it.
class CurvatureField {
 public:
  /// S of a sector in the tangent and bitangent of `Frame::around(its normal)`: xx, xy, yy.
  using Tensor = std::array<double, 3>;

  CurvatureField(const SurfaceMesh& mesh, std::vector<Tensor> tensors, std::size_t fallbacks)
      : mesh_(&mesh), tensors_(std::move(tensors)), fallbacks_(fallbacks) {}

  /// At barycentric coordinates of a face, tangent to the normalised interpolation n of the corner
  /// normals: S = sum_j b_j Q_j S_j Q_j^T, where Q_j is the smallest rotation from n_j to n.
  [[nodiscard]] Mat3 shape_operator(std::size_t face, const Vec3& barycentric) const;
  [[nodiscard]] Mat3 shape_operator(std::size_t sector) const;

  /// Sectors whose surroundings were too small for a jet and that have the face tensors instead.
  [[nodiscard]] std::size_t fallback_count() const { return fallbacks_; }
  [[nodiscard]] const SurfaceMesh& mesh() const { return *mesh_; }

 private:
  const SurfaceMesh* mesh_;
  std::vector<Tensor> tensors_;  ///< Per sector.
  std::size_t fallbacks_;
};

[[nodiscard]] CurvatureField estimate_curvature(const SurfaceMesh& mesh,
                                                const CurvatureOptions& options = {});

/// `shape_operator` as CurvatureField gives it; `normal` is the unit normal in its null space.
[[nodiscard]] PrincipalCurvatures principal_curvatures(const Mat3& shape_operator, const Vec3& normal);

/// The smallest rotation that takes the unit vector `from` to `to`; for opposite vectors, which have
/// no smallest one, a half turn.
[[nodiscard]] Mat3 minimal_rotation(const Vec3& from, const Vec3& to);

}  // namespace vrc
