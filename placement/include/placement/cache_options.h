// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace vrc {

enum class PlacementMetric {
  kHessian,      ///< Radii from eq. 4.
  kUniform,      ///< One radius everywhere (for comparison).
  kSplitSphere,  ///< A share of the mean distance of what a record sees, and Ward's weights [Ward1988].
};

enum class Sampler {
  kImage,    ///< Pixel centres in coarse-to-fine order.
  kSurface,  ///< Neighbours around the ellipses of records, over the charts of the surfaces.
};

/// What the radii of records bound the error of.
enum class Strategy {
  kViewDependent,           ///< Radiance towards the camera [Zhao 4.1.1].
  kViewIndependent,         ///< Incident radiance from all directions [Zhao eq. 5-6].
  kViewIndependentOutgoing  ///< Outgoing radiance in all directions.
};

/// What records hold.
enum class Representation {
  kAnalytic,   ///< Radiance towards the camera with its derivatives.
  kHarmonics,  ///< Incident radiance in spherical harmonics.
  kHybrid,     ///< Radiance, but spherical harmonics where `HarmonicsRule` says so.
  kIrradiance  ///< Irradiance with derivatives, on diffuse surfaces.
};

/// How the rays of spherical harmonics are distributed.
enum class HarmonicsRays {
  kAuto,     ///< kBrdf with a view-dependent strategy, kCosine otherwise.
  kUniform,  ///< Over the hemisphere [Zhao eq. 7].
  kCosine,
  kBrdf  ///< As those of radiance: by the cosine and by the lobes towards the camera.
};

/// Where the derivatives of irradiance come from.
enum class IrradianceDerivatives {
  kStrata,    ///< Translational gradient from the borders of hemisphere cells [WardHeckbert1992].
  kTriangles  ///< Gradient and Hessian of triangles through the hits [Schwarzhaupt2012].
};

/// Where a hybrid cache holds spherical harmonics.
enum class HarmonicsRule {
  kPaper,  ///< Where the normal turns by more than theta_max within the ellipse [Zhao 4.3.4].
  kAuto    ///< Where measurements say that they are better (docs/decisions).
};

/// What the noise of records and hard pixels follow where the number of records is given.
inline constexpr double kErrorWithNumber = 0.03;

inline constexpr double kLargestNormalDeviation = 0.15;  // [rad]

/// How records are made. The defaults need no tuning on ordinary scenes.
struct CacheOptions {
  double error = 0.02;  ///< Accepted relative error of the picture; smaller makes more records.
  /// Of the picture, as far as the records tell it before all is shaded; false: what records are placed for,
  /// about twice the picture's.
  bool error_of_picture = true;
  int records = 0;       ///< > 0: adapt the error threshold to reach this many within 5 %.
  int gather_rays = 0;   ///< Mean rays of a record, each a power of two from 1024 on; 0 chooses by the noise.
  int taylor_order = 2;  ///< 0, 1 or 2: the order of the interpolant of eq. 13.
  bool glossy_glossy = true;  ///< Derivative of the incident radiance reflected by glossy surfaces.
  /// Derivatives know how the surface bends and how GGX masks; false: [Zhao eq. 10-11, 4.3.2].
  bool total_derivative = true;
  /// Derivatives know how silhouettes move over what is behind them.
  bool occlusion_aware = true;
  bool joint_weight = true;  ///< Normals count in the distance of eq. 14; false: k_t alone.
  Sampler sampler = Sampler::kImage;
  PlacementMetric metric = PlacementMetric::kHessian;
  /// theta_max of eq. 13; 0: by the lobes of each material and the error, kLargestNormalDeviation at most.
  /// [rad]
  double max_normal_deviation = 0.0;
  /// Of g g^T / L in the metric of eq. 4, for slopes where H passes 0; 0: eq. 4.
  double gradient_share = 1.0;
  /// Of the picture's mean luminance, added in quadrature to the L of eq. 4 where that would vanish; 0: L.
  double dark_share = 0.2;
  Strategy strategy = Strategy::kViewDependent;
  Representation representation = Representation::kHybrid;
  HarmonicsRule harmonics_rule = HarmonicsRule::kAuto;
  IrradianceDerivatives irradiance_derivatives = IrradianceDerivatives::kStrata;
  HarmonicsRays harmonics_rays = HarmonicsRays::kAuto;
  int harmonics_order = 0;     ///< Of spherical harmonics; 0 chooses by each material's own lobes.
  double blend_support = 1.4;  ///< Regions are blended up to this multiple of their radii; 1: [Zhao eq. 13].
  bool guided = true;          ///< Records send their rays where their neighbours' rays found light.
  bool supersample_edges = true;  ///< Pixels whose samples see different surfaces get more of them.
  bool hard_pixels = true;        ///< Pixels that records show badly are gathered again.
  bool joint_fit = true;          ///< Refine records by their neighbours' values, weighted by noise.
  /// All records get a class; false: only those whose representation follows from it.
  bool classify_sites = true;
  /// Records are made before the picture is shaded; false: while it is, line by line and one after another,
  /// so that a pixel blends only what it or earlier pixels asked for [Zhao 3]. Then without what needs all
  /// records (joint_fit, hard_pixels, error_of_picture) and not with Sampler::kSurface.
  bool overture = true;

  /// What decides whether a surface turns: the theta_max that is given, or the largest.
  [[nodiscard]] double turning_angle() const {
    return max_normal_deviation > 0.0 ? max_normal_deviation : kLargestNormalDeviation;
  }
};

}  // namespace vrc
