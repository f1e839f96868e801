// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "core/frame.h"
#include "core/jet2.h"
#include "core/types.h"

namespace vrc {

/// Where a record may be used: an ellipsoid around it, the axes along the surface from the Hessian.
struct ValidRegion {
  Vec3 center;
  Vec3 normal;
  Vec3 axis1, axis2;  ///< Unit, tangent: eigenvectors of the luminance Hessian.
  double radius1 = 0.0, radius2 = 0.0;
  double normal_radius = 0.0;
  double cos_max_deviation = 0.0;     ///< Cosine of theta_max.
  double cos_widest_deviation = 1.0;  ///< Of points that no region reaches; `cos_max_deviation` if larger.
  bool split_sphere = false;          ///< Weighted as irradiance caching does instead of eq. 14.
  bool normals_count = true;          ///< In the distance k; false: it is k_t.

  /// What the turn 1 - cos of the normals adds to k^2 is multiplied by.
  [[nodiscard]] double inverse_deviation() const {
    return normals_count ? 1.0 / std::max(1.0 - cos_max_deviation, 1e-12) : 0.0;
  }
};

/// How far the normals of points that a region holds may deviate from its own.
enum class Deviation {
  kAccepted,  ///< By `cos_max_deviation`.
  kWidest     ///< By `cos_widest_deviation`.
};

/// The region with the widest deviation.
[[nodiscard]] inline ValidRegion turned_widest(ValidRegion region) {
  region.cos_max_deviation = std::min(region.cos_max_deviation, region.cos_widest_deviation);
  return region;
}

/// Translation weight k_t of [Zhao eq. 15]; 1 on the ellipsoid.
[[nodiscard]] inline double translation_distance(const ValidRegion& region, const Vec3& x) {
  const Vec3 d = x - region.center;
  const double a = d.dot(region.axis1) / region.radius1;
  const double b = d.dot(region.axis2) / region.radius2;
  const double c = d.dot(region.normal) / region.normal_radius;
  return std::sqrt(a * a + b * b + c * c);
}

/// Distance k in position and orientation together: k^2 = k_t^2 + (angle of the normals / theta_max)^2,
/// unless the region says k_t. On a plane it is k_t. 2 (1 - cos) stands for the squared angle.
[[nodiscard]] inline double joint_distance(const ValidRegion& region, const Vec3& x, const Vec3& n,
                                           double support = 1.0) {
  const double kt = translation_distance(region, x) / support;
  return std::sqrt(kt * kt + std::max(0.0, 1.0 - region.normal.dot(n)) * region.inverse_deviation());
}

/// Below it the weight of a split sphere stays finite.
inline constexpr double kSmallestSplitDistance = 1e-3;

/// The weight of a record at x with normal n: [Zhao eq. 14] with the joint distance k in the place of
/// k_t, the ellipsoid widened `support` times; 0 where the normals differ by more than theta_max. Of
/// split spheres 1 / k - 1 [Ward1988, moved to 0 at the border].
[[nodiscard]] inline double weight(const ValidRegion& region, const Vec3& x, const Vec3& n,
                                   double support = 1.0) {
  const double kr = region.normal.dot(n);
  if (kr < region.cos_max_deviation) return 0.0;
  const double k = joint_distance(region, x, n, support);
  if (region.split_sphere) return std::max(0.0, 1.0 / std::max(k, kSmallestSplitDistance) - 1.0);
  return std::max(0.0, 1.0 - k * kr) * std::pow(std::max(0.0, kr), 16.0);
}

/// Half axes and directions of an ellipse in tangent coordinates.
struct RegionAxes {
  Vec2 axis1, axis2;
  double radius1, radius2;
};

/// [Zhao eq. 4] with `reference` in the place of L: R_j = (4 epsilon reference / (pi |u_j|))^(1/4), at
/// most `maximum`. `epsilon` has units of length^2. The u_j are the eigenvalues of
/// |H| + gradient_share g g^T / reference; share 0 is the paper's.
[[nodiscard]] RegionAxes hessian_radii(const Jet2& jet, double reference, double epsilon,
                                       double gradient_share, double maximum);

/// The largest ellipse, about, inside both a given one and that with half axes `across` along the
/// unit vector `direction` and `along` perpendicular to it (the sum of their inverse squares).
[[nodiscard]] RegionAxes intersection(const RegionAxes& axes, const Vec2& direction, double across,
                                      double along);

}  // namespace vrc
