// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/frame.h"
#include "core/types.h"
#include "geometry/surface_mesh.h"

namespace vrc {

/// An ellipse in the tangent plane at a point of a mesh.
struct SurfaceEllipse {
  std::uint32_t face = 0;
  Vec3 barycentric = Vec3(1.0, 0.0, 0.0);
  /// The normal is the shading normal there, or its opposite; tangent and bitangent are the axes.
  Frame frame;
  Vec2 radii = Vec2::Ones();  ///< Along tangent and bitangent. [world units]
};

/// A face that an ellipse reaches.
struct WalkedFace {
  std::uint32_t face = 0;
  /// Its corners unfolded into the tangent plane: coordinates along the axes of the ellipse, whose
  /// centre is (0, 0). [world units] Clockwise where the ellipse's normal is reversed.
  std::array<Vec2, 3> corners;
  /// Between the ellipse's normal and the shading normals of the part inside the ellipse. [radians]
  double normal_deviation = 0.0;
};

struct SurfaceWalk {
  std::vector<WalkedFace> faces;  ///< Each once; the ellipse's own first, then nearest first.
  double normal_deviation = 0.0;  ///< Largest of the faces. [radians]
  bool truncated = false;         ///< More than `max_faces` were reached; the nearest are kept.
};

struct SurfaceWalkOptions {
  std::size_t max_faces = 1 << 16;
  /// Faces whose shading normals all turn away from the ellipse's by more are not entered. [radians]
  double max_deviation = std::numeric_limits<double>::infinity();
  bool measure_deviation = true;  ///< false: the walk's `normal_deviation` stays 0, and costs nothing.
};

/// Finds the faces that an ellipse reaches along the surface: neighbours are unfolded into its tangent
/// plane, across every smooth edge that meets the ellipse there, nearest edge first. Never across
/// creases or boundaries, so nothing leaks to another sheet. Lengths along unfolded straight lines are
/// geodesic; on a surface of curvature k the distance s of a corner is off by about (k s)^2 / 12.
///
/// The face of the centre is turned into the tangent plane by the smallest rotation. Costs grow with
/// the faces reached only. `mesh` must outlive the call.
[[nodiscard]] SurfaceWalk walk_surface(const SurfaceMesh& mesh, const SurfaceEllipse& ellipse,
                                       const SurfaceWalkOptions& options = {});

/// The ellipse around a point with the shading normal there (that of the face where it vanishes);
/// `tangent` is projected to the tangent plane and must not be parallel to the normal.
[[nodiscard]] SurfaceEllipse make_ellipse(const SurfaceMesh& mesh, std::uint32_t face,
                                          const Vec3& barycentric, const Vec3& tangent, const Vec2& radii);

/// Whether the closed segment meets the closed ellipse around (0, 0) with radii along the axes.
[[nodiscard]] bool meets_ellipse(const Vec2& a, const Vec2& b, const Vec2& radii);

}  // namespace vrc
