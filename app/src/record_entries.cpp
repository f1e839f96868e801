// SPDX-License-Identifier: GPL-3.0-or-later
#include "record_entries.h"

#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "placement/surface_reach.h"

namespace vrc {
namespace {

void set_gathered(RecordMapEntry& entry, const RadianceEstimate& estimate) {
  entry.luminance_deviation = static_cast<float>(std::sqrt(std::max(0.0, estimate.variance.value)));
  entry.nearest_hit = static_cast<float>(estimate.hits.nearest);
  entry.mean_hit = static_cast<float>(1.0 / estimate.hits.mean_inverse);  // infinite for 0
}

/// How the film position of a point moves with the point, to first order. [pixels]
Vec2 film_displacement(const Camera& camera, const Vec3& point, const Vec3& step) {
  const Vec3 d = point - camera.origin;
  const double depth = d.dot(camera.forward);
  const Vec3 across = (step - step.dot(camera.forward) / depth * d) / (depth * camera.pixel_size());
  return {across.dot(camera.right), -across.dot(camera.up)};
}

void set_film(RecordMapEntry& entry, const Camera& camera, const ValidRegion& region) {
  if (!((region.center - camera.origin).dot(camera.forward) > 0.0)) {
    entry.film = entry.film_axis1 = entry.film_axis2 =
        Vec2f::Constant(std::numeric_limits<float>::quiet_NaN());
    return;
  }
  const auto moved = [&](const Vec3& step) {
    return film_displacement(camera, region.center, step).cast<float>().eval();
  };
  entry.film = camera.film_position(region.center).cast<float>();
  entry.film_axis1 = moved(region.radius1 * region.axis1);
  entry.film_axis2 = moved(region.radius2 * region.axis2);
}

RecordMapEntry entry_of(const SceneCharts& charts, const RadianceRecord& record) {
  const ValidRegion& region = record.region;
  const Jet2 jet = luminance(record.radiance);
  // Rows: the axes of the region in the frame of the derivatives.
  const Frame& frame = record.site.frame;
  Mat2 axes;
  axes << frame.tangent.dot(region.axis1), frame.bitangent.dot(region.axis1), frame.tangent.dot(region.axis2),
      frame.bitangent.dot(region.axis2);
  const Mat2 hessian = axes * jet.hessian * axes.transpose();

  RecordMapEntry entry;
  entry.position = region.center.cast<float>();
  entry.normal = region.normal.cast<float>();
  entry.axis1 = region.axis1.cast<float>();
  entry.axis2 = region.axis2.cast<float>();
  entry.radius1 = static_cast<float>(region.radius1);
  entry.radius2 = static_cast<float>(region.radius2);
  for (std::size_t c = 0; c < 3; ++c) {
    entry.radiance[static_cast<Eigen::Index>(c)] = static_cast<float>(record.radiance[c].value);
  }
  entry.gradient = (axes * jet.gradient).cast<float>();
  entry.hessian = Vec3(hessian(0, 0), hessian(0, 1), hessian(1, 1)).cast<float>();
  entry.clamp_factor = static_cast<float>(record.clamp_factor);
  set_gathered(entry, record.estimate);
  entry.curvature = record.curvature;
  entry.harmonics_reason = record.harmonics_reason;
  const SurfacePoint& point = record.site.point;
  entry.region = static_cast<std::uint32_t>(point.region);
  entry.face = point.triangle;
  entry.patch = charts.patch_of(point.triangle);
  entry.uv =
      charts.uv(point.triangle, static_cast<double>(point.u), static_cast<double>(point.v)).cast<float>();
  entry.rays = record.rays;
  set_film(entry, charts.scene().camera(), region);
  return entry;
}

}  // namespace

std::vector<RecordMapEntry> record_entries(const RadianceCache& cache) {
  std::vector<RecordMapEntry> entries;
  entries.reserve(cache.records().size());
  for (const RadianceRecord& record : cache.records()) entries.push_back(entry_of(cache.charts(), record));
  return entries;
}

std::vector<EllipseTessellation> record_tessellations(const RadianceCache& cache) {
  constexpr double kLift = 1e-4;  // of the scene's radius
  const Scene& scene = cache.charts().scene();
  EllipseTessellationOptions options;
  options.segments = 32;
  options.lift = kLift * scene.radius();
  std::vector<EllipseTessellation> result(cache.records().size());
  parallel_for(result.size(), [&](std::size_t i) {
    const RadianceRecord& record = cache.records()[i];
    const SurfacePoint& point = record.site.point;
    const SurfaceMesh& mesh = scene.surface_mesh(scene.surface_of(point.triangle));
    result[i] = tessellate_ellipse(mesh, surface_ellipse(scene, point, record.region, 1.0), options);
  });
  return result;
}

}  // namespace vrc
