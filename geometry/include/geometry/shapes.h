// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/polygon_soup.h"

namespace vrc {

// Mitsuba's procedural shapes in their local frames; normals point out (or along +z).

/// [-1, 1]^2 in the plane z = 0, normal +z, uv in [0, 1]^2.
[[nodiscard]] PolygonSoup make_rectangle();
/// [-1, 1]^3, six quads, outward normals.
[[nodiscard]] PolygonSoup make_cube();
/// Unit disk in the plane z = 0, normal +z.
[[nodiscard]] PolygonSoup make_disk(int segments = 256);
/// Lateral surface from `p0` to `p1`, exact radial normals, no caps.
[[nodiscard]] PolygonSoup make_cylinder(const Vec3& p0, const Vec3& p1, double radius, int segments = 256);
/// Tessellated finely (a subdivided cube projected to the sphere) with exact normals;
/// `subdivision` quads along each edge of the cube.
[[nodiscard]] PolygonSoup make_sphere(const Vec3& center, double radius, int subdivision = 48);

}  // namespace vrc
