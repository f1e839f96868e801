// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/camera.h"

#include <cmath>

#include "core/error.h"

namespace vrc {

Vec3 Camera::direction(double film_x, double film_y) const {
  const double half_pixel = tan_half_width / width;
  return forward + (2.0 * film_x - width) * half_pixel * right + (height - 2.0 * film_y) * half_pixel * up;
}

Vec2 Camera::film_position(const Vec3& point) const {
  const double half_pixel = tan_half_width / width;
  const Vec3 d = (point - origin) / (point - origin).dot(forward);
  return {0.5 * (width + d.dot(right) / half_pixel), 0.5 * (height - d.dot(up) / half_pixel)};
}

void Camera::resize(int new_width, int new_height) {
  VRC_CHECK(new_width > 0 && new_height > 0, "film of {} x {} pixels", new_width, new_height);
  width = new_width;
  height = new_height;
}

Camera look_at(const Vec3& origin, const Vec3& target, const Vec3& up, double fov_degrees, int width,
               int height) {
  const auto fail = [&](const std::string& problem) {
    throw InputError(
        fmt::format("camera at ({:g}, {:g}, {:g}): {}", origin.x(), origin.y(), origin.z(), problem));
  };
  if (!(fov_degrees > 0.0 && fov_degrees < 180.0)) {
    fail(fmt::format("a field of view of {:g} degrees; give one between 0 and 180", fov_degrees));
  }
  if (!origin.allFinite() || !target.allFinite() || !up.allFinite()) fail("a coordinate is not finite");
  const Vec3 view = target - origin;
  if (!(view.norm() > 0.0)) fail("origin and target coincide; move one of them");
  Camera camera;
  camera.origin = origin;
  camera.forward = view.normalized();
  const Vec3 across = camera.forward.cross(up);
  if (!(across.norm() > 1e-9 * up.norm()))
    fail("the up vector is zero or parallel to the view; give another");
  camera.right = across.normalized();
  camera.up = camera.right.cross(camera.forward);
  camera.tan_half_width = std::tan(0.5 * fov_degrees * kPi / 180.0);
  camera.resize(width, height);
  return camera;
}

}  // namespace vrc
