// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/types.h"

namespace vrc {

/// What an edge adds to the derivatives of the form factor of polygons on its left, as seen from above
/// the point that sees them.
struct EdgeDerivatives {
  Vec2 gradient = Vec2::Zero();
  Mat2 hessian = Mat2::Zero();
};

/// For the edge between two points in the frame of the receiver (z is its normal), which moves in its
/// tangent plane. The formulas are those of `gather_irradiance` [Schwarzhaupt2012].
[[nodiscard]] EdgeDerivatives edge_derivatives(const Vec3& from, const Vec3& to);

}  // namespace vrc
