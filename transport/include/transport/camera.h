// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/types.h"

namespace vrc {

/// Pinhole camera. Film coordinates: x to the right, y downwards, in pixels, [0, width) x [0, height).
struct Camera {
  Vec3 origin = Vec3::Zero();
  Vec3 right = Vec3::UnitX();  ///< Unit vectors in world space; right x up = -forward, or +forward
                               ///< for a mirrored image.
  Vec3 up = Vec3::UnitY();
  Vec3 forward = -Vec3::UnitZ();
  double tan_half_width = 0.5;  ///< Tangent of half the horizontal field of view; the vertical
                                ///< one follows from square pixels.
  int width = 512;
  int height = 512;

  /// Direction (not normalised, forward component 1) through a film position.
  [[nodiscard]] Vec3 direction(double film_x, double film_y) const;

  /// The inverse: where a point in front of the camera lies on the film.
  [[nodiscard]] Vec2 film_position(const Vec3& point) const;

  /// Length that one pixel spans at unit distance along `forward`, on a plane facing the camera.
  [[nodiscard]] double pixel_size() const { return 2.0 * tan_half_width / width; }

  /// Same view, another film size: the horizontal field of view is kept.
  void resize(int new_width, int new_height);
};

/// `fov_degrees` spans the horizontal axis. Throws InputError when origin and target coincide or
/// `up` is parallel to the view.
[[nodiscard]] Camera look_at(const Vec3& origin, const Vec3& target, const Vec3& up, double fov_degrees,
                             int width, int height);

}  // namespace vrc
