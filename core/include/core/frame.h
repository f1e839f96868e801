// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "core/types.h"

namespace vrc {

/// Right-handed orthonormal frame; `normal` = `tangent` x `bitangent`.
struct Frame {
  Vec3 tangent = Vec3::UnitX();
  Vec3 bitangent = Vec3::UnitY();
  Vec3 normal = Vec3::UnitZ();

  /// Any frame around a unit normal, without branches on the sphere except one seam [Duff2017].
  [[nodiscard]] static Frame around(const Vec3& n) {
    const double sign = std::copysign(1.0, n.z());
    const double a = -1.0 / (sign + n.z());
    const double b = n.x() * n.y() * a;
    return {
        {1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()}, {b, sign + n.y() * n.y() * a, -n.y()}, n};
  }
};

}  // namespace vrc
