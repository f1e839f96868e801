// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "placement/cache_options.h"
#include "placement/record.h"

namespace vrc {

/// Turns gathered radiance into records: valid regions [Zhao eq. 4] and limits on the derivatives.
struct RegionRule {
  const CacheOptions* options = nullptr;
  double epsilon = 1e-4;        ///< Threshold of eq. 4 in units of (picture width)^2: free of scale.
  double mean_luminance = 1.0;  ///< Of the picture's indirect light; bounds relative errors in the dark.
  int picture_width = 512;      ///< Pixels.
  double uniform_radius = 0.0;  ///< PlacementMetric::kUniform: radius in picture widths.
};

/// Largest angle of normals across a record of spherical harmonics. [rad]
inline constexpr double kHarmonicsTurn = 0.5;

/// The half axes of a region in a record's frame, as columns.
[[nodiscard]] Mat2 half_axes(const ValidRegion& region, const Frame& frame);

/// sqrt(L^2 + (dark_share mean)^2): the L of the relative error, kept away from 0 in the dark.
[[nodiscard]] double perceived(double value, double mean_luminance,
                               double dark_share = CacheOptions{}.dark_share);

/// The accuracy of irradiance caching that stands for a threshold: radii are this share of the mean
/// distance, and normals may differ by about 1.4 times as many radians. 0.2 at --error 0.03.
[[nodiscard]] double split_sphere_share(double epsilon);

/// Fills the record's region, radiance, tilts and clamp factor from its estimate. The radii lie between one
/// pixel and a tenth of the picture, within the nearest gather hit, and along the crease of a wall
/// within six times as much.
/// `sharpness` is the weighted one of the record's BRDF, which theta_max follows where none is given.
void shape_record(RadianceRecord& record, const RegionRule& rule, double sharpness);

/// The theta_max that goes with a threshold and the weighted sharpness of a BRDF (docs/decisions/004):
/// 0.95 (epsilon / sharpness^2)^(1/8), kLargestNormalDeviation at most. [rad]
[[nodiscard]] double normal_deviation_for(double epsilon, double sharpness);

/// Sets the radiance that a record with a known region passes on. Where the region reaches beyond the
/// nearest hit, gradient and Hessian are scaled by the ratio and its square; then until neither changes
/// the radiance by more than `perceived` over the region. `clamp_factor` says by how much. Spherical
/// harmonics are limited likewise, by the Euclidean norm of their luminance.
void set_radiance(RadianceRecord& record, const std::array<Jet2, 3>& jets, double mean_luminance);

/// How noisy a record may be before it is gathered again with more rays.
struct NoiseGoal {
  double relative = 0.0;  ///< Standard deviation over `perceived` luminance; 0: never again.
  double mean_luminance = 1.0;
};

/// What makes an estimate at a site with 2^log2_rays rays.
using Gather = std::function<RadianceEstimate(const RecordSite& site, int log2_rays)>;

/// Gathers at the site. A site closer than half a pixel to the nearest hit (in a crease) is moved
/// half a pixel away from it first, along its surface, and gathered again; so is a record that
/// misses the noise goal, with the rays that its variance asks for.
[[nodiscard]] RadianceRecord make_record(const Scene& scene, const RecordSite& site, const Gather& gather,
                                         int log2_rays, const NoiseGoal& goal);

inline constexpr double kVarianceConvergence = 1.1;  ///< Variance falls as rays^-1.1 with Sobol points.
inline constexpr int kFewestLog2Rays = 10;
inline constexpr int kMostLog2Rays = 16;

/// log2 of the rays that bring a deviation measured with 2^log2_rays down to a wanted one, within
/// [kFewestLog2Rays, kMostLog2Rays].
[[nodiscard]] double log2_rays_for(double log2_rays, double deviation, double wanted);

}  // namespace vrc
