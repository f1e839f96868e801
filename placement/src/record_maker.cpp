// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/record_maker.h"

#include <algorithm>
#include <cmath>

namespace vrc {
namespace {

constexpr double kDarkShare = 0.2;            // of the mean luminance, in `perceived`
constexpr double kMaximumPictureShare = 0.1;  // [Zhao 5]
constexpr double kSteepWall = 0.5;            // sine of the least angle between surface and wall
constexpr double kAlongCrease = 6.0;          // times the nearest hit: along the crease of a wall

/// The same surface half a pixel farther from the nearest hit; nothing when the surface ends there.
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
  return scene.surface_point(triangle, hit.u[0], hit.v[0], scene.camera().origin);
}

/// Scales derivatives so that over the half axes neither order changes the value by more than `limit`.
double limit_jet(Jet2& jet, const Vec2& half1, const Vec2& half2, double limit) {
  double factor = 1.0;
  const double change = std::hypot(jet.gradient.dot(half1), jet.gradient.dot(half2));
  if (change > limit) {
    factor = limit / change;
    jet.gradient *= factor;
  }
  Mat2 h;
  h << half1.dot(jet.hessian * half1), half1.dot(jet.hessian * half2), half2.dot(jet.hessian * half1),
      half2.dot(jet.hessian * half2);
  const double bend = 0.5 * h.norm();
  if (bend > limit) {
    jet.hessian *= limit / bend;
    factor = std::min(factor, limit / bend);
  }
  return factor;
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

}  // namespace

double perceived(double value, double mean_luminance) {
  return std::sqrt(value * value + kDarkShare * kDarkShare * mean_luminance * mean_luminance);
}

void shape_record(RadianceRecord& record, const RegionRule& rule) {
  const RecordSite& site = record.site;
  const double picture = site.pixel_length * rule.picture_width;

  const Jet2& brightness = record.estimate.luminance;
  const double reference = perceived(brightness.value, rule.mean_luminance);
  RegionAxes axes = hessian_radii(brightness, reference, rule.epsilon * picture * picture,
                                  rule.options->gradient_share, kMaximumPictureShare * picture);
  if (rule.options->metric == PlacementMetric::kUniform) {
    axes.radius1 = axes.radius2 = rule.uniform_radius * picture;
  } else {
    axes = within_nearest_hit(axes, record);
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
  region.cos_max_deviation = std::cos(rule.options->max_normal_deviation);
  set_radiance(record, record.estimate.radiance, rule.mean_luminance);
}

void set_radiance(RadianceRecord& record, const std::array<Jet2, 3>& jets, double mean_luminance) {
  const ValidRegion& region = record.region;
  const Frame& frame = record.site.frame;
  const Vec2 half1 =
      region.radius1 * Vec2(region.axis1.dot(frame.tangent), region.axis1.dot(frame.bitangent));
  const Vec2 half2 =
      region.radius2 * Vec2(region.axis2.dot(frame.tangent), region.axis2.dot(frame.bitangent));
  record.radiance = jets;
  record.clamp_factor = 1.0;
  // Derivatives hold no farther than the nearest hit; a region that the minimum radius makes larger
  // extrapolates as if its edge were there.
  const double trust = std::min(1.0, record.estimate.hits.nearest / std::max(region.radius1, region.radius2));
  for (Jet2& jet : record.radiance) {
    jet.gradient *= trust;
    jet.hessian *= trust * trust;
    const double factor = trust * limit_jet(jet, half1, half2, perceived(jet.value, mean_luminance));
    record.clamp_factor = std::min(record.clamp_factor, factor);
  }
}

int log2_rays_for(int log2_rays, double deviation, double wanted) {
  const double doublings = 2.0 / kVarianceConvergence * std::log2(std::max(deviation / wanted, 1e-9));
  return std::clamp(log2_rays + static_cast<int>(std::lround(doublings)), kFewestLog2Rays, kMostLog2Rays);
}

RadianceRecord make_record(const Scene& scene, const RecordSite& site, const GatherOptions& gather,
                           const NoiseGoal& goal, RayCounts& counts) {
  RadianceRecord record;
  record.site = site;
  record.estimate = gather_radiance(scene, site, gather, counts);
  if (record.estimate.hits.nearest < 0.5 * site.pixel_length) {
    if (const auto moved = moved_out_of_crease(scene, site, record.estimate.hits.nearest_direction)) {
      record.site = make_site(scene, *moved, site.key);
      record.estimate = gather_radiance(scene, record.site, gather, counts);
    }
  }
  if (goal.relative > 0.0) {
    const double deviation = std::sqrt(record.estimate.variance.value);
    const double wanted = goal.relative * perceived(record.estimate.luminance.value, goal.mean_luminance);
    GatherOptions more = gather;
    more.log2_rays = log2_rays_for(gather.log2_rays, deviation, wanted);
    if (more.log2_rays > gather.log2_rays)
      record.estimate = gather_radiance(scene, record.site, more, counts);
  }
  return record;
}

}  // namespace vrc
