// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/record_maker.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace vrc {
namespace {

constexpr double kMaximumPictureShare = 0.1;    // [Zhao 5]
constexpr double kSteepWall = 0.5;              // sine of the least angle between surface and wall
constexpr double kMisfit = 30.0;                // squared errors beyond the accepted one, by the square of it
constexpr double kNormalDeviation = 0.95;       // theta_max by (threshold of eq. 4 / sharpness^2)^(1/8)
constexpr double kWidestNormalDeviation = 0.3;  // of points that no region reaches [rad]
constexpr double kAlongCrease = 6.0;            // times the nearest hit: along the crease of a wall

/// The same surface half a pixel farther from the nearest hit; nothing when the surface ends there or turns
/// so far that a record there would not serve the site.
std::optional<SurfacePoint> moved_out_of_crease(const Scene& scene, const RecordSite& site,
                                                const Vec3& nearest) {
  const Vec3 tangential = nearest - nearest.dot(site.point.normal) * site.point.normal;
  if (tangential.norm() < 1e-6) return std::nullopt;
  const double step = 0.5 * site.pixel_length;
  const double height = site.pixel_length;
  const Vec3 from =
      site.point.position - step * tangential.normalized() + height * site.point.geometric_normal;
  I16 first{};
  first[0] = -1;
  const Ray16 ray = {splat3(from), splat3(Vec3(-site.point.geometric_normal)),
                     splat(static_cast<float>(2.0 * height))};
  const Hit16 hit = scene.tracer().intersect(first, ray, RayTracer::Coherence::kIncoherent);
  if (hit.hit[0] == 0) return std::nullopt;
  const auto triangle = static_cast<std::uint32_t>(hit.triangle[0]);
  if (scene.triangles()[triangle].region != site.point.region) return std::nullopt;
  const SurfacePoint moved = scene.surface_point(triangle, hit.u[0], hit.v[0], scene.camera().origin);
  if (moved.normal.dot(site.point.normal) < std::cos(kHarmonicsTurn)) return std::nullopt;
  return moved;
}

/// What limits the derivatives of something over an ellipse.
struct Limits {
  double gradient = 1.0, hessian = 1.0;
};

/// The factors that bring the changes of both orders over the ellipse down to `limit`.
Limits limits_for(double gradient_change, double hessian_change, double limit) {
  return {gradient_change > limit ? limit / gradient_change : 1.0,
          hessian_change > limit ? limit / hessian_change : 1.0};
}

/// Changes of a jet over the region by its two orders.
Limits limits_of(const Jet2& jet, const Mat2& half, double limit) {
  return limits_for((half.transpose() * jet.gradient).norm(),
                    0.5 * (half.transpose() * jet.hessian * half).norm(), limit);
}

/// Of all coefficients of the luminance together, which change like a vector.
Limits limits_of(const IncidentHarmonics& incident, const Mat2& half) {
  constexpr int kEntries = IncidentHarmonics::kEntries;
  const IncidentHarmonics::Coefficients coefficients = incident.coefficients();
  const auto luminances = [&](int entry) -> Eigen::ArrayXd {
    const auto row = [&](int c) { return coefficients.row(kEntries * c + entry).transpose().cast<double>(); };
    return kLuminance[0] * row(0) + kLuminance[1] * row(1) + kLuminance[2] * row(2);
  };
  const Eigen::ArrayXd d1 = luminances(1), d2 = luminances(2);
  const Eigen::ArrayXd h11 = luminances(3), h12 = luminances(4), h22 = luminances(5);
  const auto squared = [](const Eigen::ArrayXd& a) { return a.matrix().squaredNorm(); };
  const auto along = [&](const Vec2& a) -> Eigen::ArrayXd { return a[0] * d1 + a[1] * d2; };
  const auto bend = [&](const Vec2& a, const Vec2& b) -> Eigen::ArrayXd {
    return a[0] * b[0] * h11 + (a[0] * b[1] + a[1] * b[0]) * h12 + a[1] * b[1] * h22;
  };
  const Vec2 a = half.col(0), b = half.col(1);
  return limits_for(std::sqrt(squared(along(a)) + squared(along(b))),
                    0.5 * std::sqrt(squared(bend(a, a)) + 2.0 * squared(bend(a, b)) + squared(bend(b, b))),
                    std::sqrt(squared(luminances(0))));
}

/// theta_max of a record that is no split sphere. [rad]
double largest_deviation(const RadianceRecord& record, const RegionRule& rule, double sharpness) {
  if (record.uses_harmonics()) return kHarmonicsTurn;
  const double given = rule.options->max_normal_deviation;
  return given > 0.0 ? given : normal_deviation_for(rule.epsilon, sharpness);
}

/// What the radii bound the error of.
const Jet2& metric_of(const RadianceRecord& record) {
  if (record.harmonics && record.harmonics->all_directions.value > 0.0)
    return record.harmonics->all_directions;
  return record.uses_harmonics() ? record.harmonics->luminance : record.estimate.luminance;
}

/// Hits stay fixed in the derivatives, so a region must not reach the nearest of them. A wall that
/// rises beside the record limits the region across their crease; along it the picture changes slowly.
RegionAxes within_nearest_hit(const RegionAxes& axes, const RadianceRecord& record) {
  const double nearest = record.estimate.hits.nearest;
  if (!std::isfinite(nearest)) return axes;
  const Frame& frame = record.site.frame;
  const Vec2 wall(record.estimate.hits.nearest_normal.dot(frame.tangent),
                  record.estimate.hits.nearest_normal.dot(frame.bitangent));
  const double steepness = wall.norm();
  if (steepness < kSteepWall) return intersection(axes, Vec2::UnitX(), nearest, nearest);
  return intersection(axes, wall / steepness, nearest, kAlongCrease * nearest);
}

/// Of a polynomial over `widened` times the radius that would do: second-order errors grow as its square.
double squared_misfit(double widened, double error, double brightness) {
  if (widened <= 1.0) return 0.0;
  const double relative = kMisfit * error * error * (std::pow(widened, 4.0) - 1.0);
  return std::min(relative, 1.0) * brightness * brightness;
}

}  // namespace

Mat2 half_axes(const ValidRegion& region, const Frame& frame) {
  Mat2 half;
  half.col(0) = region.radius1 * Vec2(region.axis1.dot(frame.tangent), region.axis1.dot(frame.bitangent));
  half.col(1) = region.radius2 * Vec2(region.axis2.dot(frame.tangent), region.axis2.dot(frame.bitangent));
  return half;
}

double perceived(double value, double mean_luminance, double dark_share) {
  return std::sqrt(value * value + dark_share * dark_share * mean_luminance * mean_luminance);
}

double split_sphere_share(double epsilon) { return 2.0 * std::pow(epsilon, 0.25); }

double normal_deviation_for(double epsilon, double sharpness) {
  return std::min(kNormalDeviation * std::pow(epsilon / std::max(sharpness * sharpness, 1e-300), 0.125),
                  kLargestNormalDeviation);
}

void shape_record(RadianceRecord& record, const RegionRule& rule, double sharpness) {
  const RecordSite& site = record.site;
  const double picture = site.pixel_length * rule.picture_width;

  const Jet2& brightness = metric_of(record);
  const double dark_share =
      rule.options->strategy == Strategy::kViewDependent ? rule.options->dark_share : 0.0;
  const double reference = std::max(perceived(brightness.value, rule.mean_luminance, dark_share), 1e-30);
  RegionAxes axes = hessian_radii(brightness, reference, rule.epsilon * picture * picture,
                                  rule.options->gradient_share, kMaximumPictureShare * picture);
  const double share = split_sphere_share(rule.epsilon);
  const bool split_sphere = rule.options->metric == PlacementMetric::kSplitSphere;
  record.misfit = 0.0;
  switch (rule.options->metric) {
    case PlacementMetric::kHessian:
      axes = within_nearest_hit(axes, record);
      record.misfit = squared_misfit(site.pixel_length / std::min(axes.radius1, axes.radius2),
                                     rule.options->error, brightness.value);
      break;
    case PlacementMetric::kUniform:
      axes.radius1 = axes.radius2 = rule.uniform_radius * picture;
      break;
    case PlacementMetric::kSplitSphere:
      axes.radius1 = axes.radius2 = std::min(share / std::max(record.estimate.hits.mean_inverse, 1e-30),
                                             kMaximumPictureShare * picture);
      break;
  }
  axes.radius1 = std::max(axes.radius1, site.pixel_length);
  axes.radius2 = std::max(axes.radius2, site.pixel_length);
  ValidRegion& region = record.region;
  region.center = site.point.position;
  region.normal = site.point.normal;
  region.axis1 = axes.axis1[0] * site.frame.tangent + axes.axis1[1] * site.frame.bitangent;
  region.axis2 = axes.axis2[0] * site.frame.tangent + axes.axis2[1] * site.frame.bitangent;
  region.radius1 = axes.radius1;
  region.radius2 = axes.radius2;
  region.normal_radius = std::min(axes.radius1, axes.radius2);
  region.split_sphere = split_sphere;
  region.cos_max_deviation = split_sphere ? 1.0 - std::min(0.5, share * share)
                                          : std::cos(largest_deviation(record, rule, sharpness));
  const bool widens = !split_sphere && rule.options->max_normal_deviation == 0.0;
  region.cos_widest_deviation = widens ? std::cos(kWidestNormalDeviation) : 1.0;
  region.normals_count = rule.options->joint_weight;
  set_radiance(record, record.uses_harmonics() ? record.harmonics->radiance : record.estimate.radiance,
               rule.mean_luminance);
}

void set_radiance(RadianceRecord& record, const std::array<Jet2, 3>& jets, double mean_luminance) {
  const ValidRegion& region = record.region;
  const Mat2 half = half_axes(region, record.site.frame);
  // Derivatives hold no farther than the nearest hit; a region that the minimum radius makes larger
  // extrapolates as if its edge were there.
  const double trust = std::min(1.0, record.estimate.hits.nearest / std::max(region.radius1, region.radius2));
  record.radiance = jets;
  record.clamp_factor = 1.0;
  std::optional<Limits> common;
  if (record.uses_harmonics()) {
    common = limits_of(record.harmonics->incident, trust * half);
    record.gradient_factor = trust * common->gradient;
    record.hessian_factor = trust * trust * common->hessian;
  }
  record.tilt = record.estimate.tilt;
  for (std::size_t c = 0; c < 3; ++c) {
    Jet2& jet = record.radiance[c];
    const double limit = perceived(jet.value, mean_luminance);
    const Limits limits = common ? *common : limits_of(jet, trust * half, limit);
    const double first = trust * limits.gradient, second = trust * trust * limits.hessian;
    jet.gradient *= first;
    jet.hessian *= second;
    // The same, so that where the shape operator is wrong what it says of the normal still cancels.
    record.tilt[c].gradient *= first;
    record.tilt[c].mixed *= second;
    record.tilt[c].hessian *= second;
    record.clamp_factor = std::min(record.clamp_factor, trust * std::min(limits.gradient, limits.hessian));
  }
}

double log2_rays_for(double log2_rays, double deviation, double wanted) {
  const double doublings = 2.0 / kVarianceConvergence * std::log2(std::max(deviation / wanted, 1e-9));
  return std::clamp(log2_rays + doublings, static_cast<double>(kFewestLog2Rays),
                    static_cast<double>(kMostLog2Rays));
}

RadianceRecord make_record(const Scene& scene, const RecordSite& site, const Gather& gather, int log2_rays,
                           const NoiseGoal& goal) {
  RadianceRecord record;
  record.site = site;
  record.estimate = gather(site, log2_rays);
  record.rays = std::uint64_t{1} << log2_rays;
  if (record.estimate.hits.nearest < 0.5 * site.pixel_length) {
    if (const auto moved = moved_out_of_crease(scene, site, record.estimate.hits.nearest_direction)) {
      record.site = make_site(scene, *moved, site.key);
      record.estimate = gather(record.site, log2_rays);
    }
  }
  if (goal.relative > 0.0) {
    const double deviation = std::sqrt(record.estimate.variance.value);
    const double wanted = goal.relative * perceived(record.estimate.luminance.value, goal.mean_luminance);
    const int more = static_cast<int>(std::lround(log2_rays_for(log2_rays, deviation, wanted)));
    if (more > log2_rays) {
      record.estimate = gather(record.site, more);
      record.rays = std::uint64_t{1} << more;
    }
  }
  return record;
}

}  // namespace vrc
