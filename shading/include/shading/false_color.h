// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>

#include "core/image.h"
#include "geometry/surface_mesh.h"
#include "transport/camera.h"

namespace vrc {

/// Linear RGB of a point of a face, given by its barycentric coordinates. Called from several threads.
using SurfaceColor = std::function<Rgb(std::size_t face, const Vec3& barycentric)>;

/// A mesh in its false colours, darkened where it turns away from the viewer, on white; 4 x 4 samples a
/// pixel. Channels R, G, B. Both sides of a face look alike.
[[nodiscard]] Image render_false_color(const SurfaceMesh& mesh, const Camera& camera,
                                       const SurfaceColor& color);

/// Triangles in the plane, three corners each, in their colours, on white: the window [0, size.x] x
/// [0, size.y] is fitted into the picture with its y axis upwards. Channels R, G, B.
[[nodiscard]] Image render_flat_triangles(std::span<const Vec2> corners, const Vec2& size, int width,
                                          int height, const SurfaceColor& color);

/// What a picture's colours mean.
struct ColorBar {
  std::string title;  ///< Lower-case letters, digits and . + - / ( ) ^ = only; others stay blank.
  double low = 0.0;   ///< Values at the ends.
  double high = 1.0;
  std::function<Rgb(double)> color;  ///< Linear RGB for positions in [0, 1].
};

/// Rows that a colour bar takes from a picture of this size; 0 when the picture is too small for one.
[[nodiscard]] int color_bar_height(int width, int height);

/// The picture with the bar and the numbers at its ends below it, `color_bar_height(width, whole height)`
/// rows more. Returns the picture as it is when `bar_height` is 0.
[[nodiscard]] Image with_color_bar(const Image& picture, const ColorBar& bar, int bar_height);

}  // namespace vrc
