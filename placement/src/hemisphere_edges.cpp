// SPDX-License-Identifier: GPL-3.0-or-later
#include "hemisphere_edges.h"

#include <cmath>

namespace vrc {

EdgeDerivatives edge_derivatives(const Vec3& from, const Vec3& to) {
  const Vec3& r = from;
  const Vec3& q = to;
  const Vec3 e = q - r, c = r.cross(q);
  const double ee = e.squaredNorm(), cc = c.squaredNorm(), rr = r.squaredNorm(), qq = q.squaredNorm();
  // Edges of no length, or that point at the receiver, do not sweep over anything.
  if (cc < 1e-18 * rr * qq || ee < 1e-18 * rr) return {};
  const double er = e.dot(r), eq = e.dot(q);
  const double angle = std::atan2(std::sqrt(cc), r.dot(q));
  const double i1 = angle / std::sqrt(cc);
  const double i2 = (eq / qq - er / rr + ee * i1) / (2.0 * cc);
  const double j2 = (0.5 * (1.0 / rr - 1.0 / qq) - er * i2) / ee;
  const double i3 = (eq / (qq * qq) - er / (rr * rr) + 3.0 * ee * i2) / (4.0 * cc);
  const double j3 = (0.25 * (1.0 / (rr * rr) - 1.0 / (qq * qq)) - er * i3) / ee;
  const double k3 = (i2 - rr * i3 - 2.0 * er * j3) / ee;

  const Vec2 rt = r.head<2>(), et = e.head<2>();
  const Vec2 a(-e.y(), e.x());  // n x e
  const double g = c.z();       // n . c
  const Vec2 b = i2 * rt + j2 * et;
  EdgeDerivatives result;
  result.gradient = (i1 * a + 2.0 * g * b) / (2.0 * kPi);
  const Mat2 bend = 4.0 * (i3 * rt * rt.transpose() + j3 * (rt * et.transpose() + et * rt.transpose()) +
                           k3 * et * et.transpose()) -
                    i2 * Mat2::Identity();
  result.hessian = (a * b.transpose() + b * a.transpose() + g * bend) / kPi;
  return result;
}

}  // namespace vrc
