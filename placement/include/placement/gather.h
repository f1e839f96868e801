// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "core/frame.h"
#include "core/jet2.h"
#include "transport/path_tracer.h"
#include "transport/scene.h"

namespace vrc {

/// Where a record is: a surface point, the tangent frame of its derivatives, and its viewer.
struct RecordSite {
  SurfacePoint point;
  Frame frame;              ///< Around point.normal.
  Vec3 to_camera;           ///< camera - x, not normalised.
  double pixel_length = 0;  ///< World length of one pixel at this distance, facing the camera.
  std::uint64_t key = 0;    ///< Seeds the record's random numbers; unique per site.
};

[[nodiscard]] RecordSite make_site(const Scene& scene, const SurfacePoint& point, std::uint64_t key);

/// How gather rays are distributed over the hemisphere of the site's normal.
enum class GatherDirections {
  kMixture,  ///< By the cosine and by the lobes of the site's BRDF.
  kCosine,
  kUniform,  ///< [Zhao eq. 7]
};

struct GatherOptions {
  int log2_rays = 12;         ///< 2^k rays, k >= 10.
  int bounces = 1;            ///< Of indirect light, as PathOptions::bounces; not 0.
  bool glossy_glossy = true;  ///< Derivative of the radiance that glossy surfaces send to the record.
  /// Along the bending surface, with the masking of GGX; false: along its tangent plane, without.
  bool total_derivative = true;
  /// Derivatives know how silhouettes move over what is behind them.
  bool occlusion_aware = true;
  /// At glossy hits the point of the lights is chosen from several by what the hits reflect of it.
  bool choose_light = false;
  GatherDirections directions = GatherDirections::kMixture;
  std::uint64_t seed = 0;
};

/// The shape operator of the surface along which a gather differentiates.
[[nodiscard]] Mat2 followed_shape_operator(const RecordSite& site, const GatherOptions& options);

/// How far the surroundings of a gather are. Where the derivatives follow a concave surface, hits on this
/// same hollow are no surroundings, except in the mean.
struct HitDistances {
  double nearest = 0.0;                   ///< Shortest ray; infinity when none counts.
  Vec3 nearest_direction = Vec3::Zero();  ///< Of that ray.
  Vec3 nearest_normal = Vec3::Zero();     ///< Geometric normal where it hit.
  double mean_inverse = 0.0;              ///< Mean of 1 / distance over the rays. [1/length]
};

/// What radiance changes by when the normal turns otherwise than the shape operator S says: a point displaced
/// by d has the normal n + S d + tau, normalised. On meshes S changes from triangle to triangle.
struct TiltJet {
  Vec2 gradient = Vec2::Zero();
  Mat2 mixed = Mat2::Zero();  ///< Second derivatives by d (rows) and tau (columns).
  Mat2 hessian = Mat2::Zero();

  [[nodiscard]] double change(const Vec2& d, const Vec2& tau) const {
    return gradient.dot(tau) + d.dot(mixed * tau) + 0.5 * tau.dot(hessian * tau);
  }
  TiltJet operator+(const TiltJet& o) const {
    return {gradient + o.gradient, mixed + o.mixed, hessian + o.hessian};
  }
};
[[nodiscard]] inline TiltJet operator*(double s, const TiltJet& j) {
  return {s * j.gradient, s * j.mixed, s * j.hessian};
}

/// The least cosine with the record's normal that the tangential part of another is divided by.
inline constexpr float kLeastTiltCosine = 0.5f;

/// The tau of a normal at tangent displacement d.
[[nodiscard]] Vec2 tilt_beyond_shape(const RecordSite& site, const Vec2& d, const Vec3& normal);

/// Outgoing radiance towards the camera and its derivatives on the surface [Zhao eq. 8-12].
struct RadianceEstimate {
  std::array<Jet2, 3> radiance;  ///< Per channel, in the site's frame.
  std::array<TiltJet, 3> tilt;   ///< Per channel; 0 where the derivatives do not follow the surface.
  Jet2 luminance;                ///< Of `radiance`.
  Jet2 variance;                 ///< Of each entry of `luminance`, from sixteen batches.
  HitDistances hits;
};

/// The luminance of a colour with derivatives.
[[nodiscard]] Jet2 luminance(const std::array<Jet2, 3>& rgb);

struct GuideHistogram;
class GuideWarp;

/// What a gather learns from others, and others from it.
struct Guidance {
  /// By other rays: where to send these; null: nowhere special. Of kMixture directions.
  const GuideWarp* warp = nullptr;
  GuideHistogram* found = nullptr;  ///< Filled with mean squares of arriving luminance, unless null.
};

/// Gathers with Owen-scrambled Sobol rays and sums the closed-form derivatives of every ray's contribution
/// while its hit stays fixed.
[[nodiscard]] RadianceEstimate gather_radiance(const Scene& scene, const RecordSite& site,
                                               const GatherOptions& options, RayCounts& counts,
                                               const Guidance& guidance = {});

}  // namespace vrc
