// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/jet2.h"
#include "placement/gather.h"
#include "placement/guide.h"
#include "placement/incident_harmonics.h"
#include "placement/site_curvature.h"
#include "placement/surface_reach.h"
#include "placement/valid_region.h"

namespace vrc {

/// Why a record holds spherical harmonics.
enum class HarmonicsReason : std::uint8_t {
  kNone,          ///< It does not.
  kAlways,        ///< All records do (Representation::kHarmonics).
  kTurns,         ///< The normal turns by more than theta_max within its ellipse.
  kReplacesMany,  ///< It stands for more Taylor records than it costs.
  kNarrow,        ///< Its normals turn as above on an edge as narrow as a pixel.
};
inline constexpr std::size_t kHarmonicsReasons = 5;

/// "none", "always", "turns", "replaces-many", "narrow".
[[nodiscard]] std::string_view name_of(HarmonicsReason reason);

/// Incident radiance at a record, and the outgoing radiance that the record's BRDF makes of it.
struct RecordHarmonics {
  IncidentHarmonics incident;
  std::array<Jet2, 3> radiance;  ///< Towards the camera, while normal and direction stay.
  Jet2 luminance;                ///< Of `radiance`.
  double variance = 0.0;         ///< Of the luminance's value.
  /// L1 norm and sum of |H| over the coefficients of luminance, incident or outgoing as the strategy
  /// says [Zhao eq. 6]; not with a view-dependent strategy.
  Jet2 all_directions;
};

/// A cached estimate of outgoing radiance: where it is, what it knows, how far it may be used.
struct RadianceRecord {
  RecordSite site;
  RadianceEstimate estimate;     ///< As gathered; never changed afterwards.
  std::array<Jet2, 3> radiance;  ///< What is interpolated: limited and fitted. In the site's frame.
  std::array<TiltJet, 3> tilt;   ///< Limited likewise.
  ValidRegion region;
  std::uint64_t rays = 0;  ///< Whose mean `estimate` is.
  std::uint32_t turn = 0;  ///< Of the first pixel that may blend it, `turn_of`; 0 with an overture.
  SiteCurvature curvature;
  /// Null until they are asked for; used when `harmonics_reason` says so.
  std::shared_ptr<const RecordHarmonics> harmonics;
  HarmonicsReason harmonics_reason = HarmonicsReason::kNone;
  std::shared_ptr<const KeptHistogram> found;  ///< By the gather's rays, for those of others; or null.
  /// Squared error of the luminance that the accepted one does not include, since the region is no smaller
  /// than a pixel; set with the region.
  double misfit = 0.0;
  double clamp_factor = 1.0;  ///< < 1: how much the crease limit reduced the derivatives.
  /// Of spherical harmonics, whose derivatives are limited where they are used.
  double gradient_factor = 1.0, hessian_factor = 1.0;

  [[nodiscard]] bool uses_harmonics() const { return harmonics_reason != HarmonicsReason::kNone; }
  /// Of the value of the luminance that it passes on.
  [[nodiscard]] double variance() const {
    return uses_harmonics() ? harmonics->variance : estimate.variance.value;
  }
};

/// When a pixel is shaded that is shaded line by line: 0 for the first.
[[nodiscard]] constexpr std::uint32_t turn_of(int x, int y) {
  return static_cast<std::uint32_t>(y) << 16 | static_cast<std::uint32_t>(x);
}

/// What each record reaches over its surface with its region widened `support` times and as far as normals
/// may deviate.
[[nodiscard]] std::vector<SurfaceReach> reaches_of(const SceneCharts& charts,
                                                   std::span<const RadianceRecord> records, double support);

}  // namespace vrc
