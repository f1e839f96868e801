// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/surface_walker.h"
#include "geometry/triangulate.h"

namespace vrc {

struct EllipseTessellationOptions {
  int segments = 64;  ///< Of the polygon inscribed in the ellipse; at least 3.
  double lift = 0.0;  ///< How far vertices are moved along the normals, to the ellipse's side. [world units]
  std::size_t max_faces = 1 << 14;  ///< See SurfaceWalkOptions.
};

/// The part of a surface that an ellipse covers, bent across the faces. Faces share no vertices.
struct EllipseTessellation {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;        ///< Unit shading normals, on the side of the ellipse's normal.
  std::vector<Triangle> triangles;  ///< Counter-clockwise when seen from that side.
};

/// A piece of the rim of an ellipse on one face.
struct OutlineSegment {
  Vec3 begin, end;
};

/// Walks over the faces that the ellipse reaches, cuts each, where it is unfolded in the tangent plane,
/// with the polygon, and takes the cut back by the face's barycentric coordinates: areas and lengths on
/// the surface are those in the plane. Ends at creases and boundaries, like the walk. The frame of the
/// ellipse must be right-handed.
[[nodiscard]] EllipseTessellation tessellate_ellipse(const SurfaceMesh& mesh, const SurfaceEllipse& ellipse,
                                                     const EllipseTessellationOptions& options = {});

/// The rim alone, in pieces that lie on one face each, in no order; it is open where the ellipse ends at
/// a crease or boundary.
[[nodiscard]] std::vector<OutlineSegment> ellipse_outline(const SurfaceMesh& mesh,
                                                          const SurfaceEllipse& ellipse,
                                                          const EllipseTessellationOptions& options = {});

}  // namespace vrc
