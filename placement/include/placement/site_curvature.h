// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

namespace vrc {

struct RadianceRecord;
class SceneCharts;

/// What decides a site's class.
enum class CurvatureReason : std::uint8_t {
  kFlat,          ///< The surface does not bend within the ellipse.
  kTurnsLittle,   ///< The normal turns by at most theta_max.
  kEllipseTurns,  ///< It turns by more by the shape operator over the ellipse.
  kSurfaceTurns,  ///< It turns by more only as the walk over the surface meets it.
};
inline constexpr std::size_t kCurvatureReasons = 4;

/// "flat", "turns-little", "ellipse-turns", "surface-turns".
[[nodiscard]] std::string_view name_of(CurvatureReason reason);

/// How strongly the surface bends in a record's would-be ellipse A = U diag(R1, R2), and what depends
/// on it.
struct SiteCurvature {
  double deviation = 0.0;           ///< delta: the larger of sigma_max(S A) and the walk's. [rad]
  double curvature = 0.0;           ///< kappa: largest |principal curvature|. [1/length]
  double relative_curvature = 0.0;  ///< kappa times the harmonic mean distance of the gather's hits.
  double exponent = 0.0;            ///< Of the sharpest lobe, as a Phong exponent; 0: diffuse.
  CurvatureReason reason = CurvatureReason::kFlat;

  /// Under the rule of [Zhao 4.3.4] the site needs spherical harmonics: delta > theta_max, the one that is
  /// given or CacheOptions::turning_angle().
  [[nodiscard]] bool needs_sh() const {
    return reason == CurvatureReason::kEllipseTurns || reason == CurvatureReason::kSurfaceTurns;
  }
};

/// Of a record with its region. theta_max in radians.
[[nodiscard]] SiteCurvature classify_site(const SceneCharts& charts, const RadianceRecord& record,
                                          double theta_max);

}  // namespace vrc
