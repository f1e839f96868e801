// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/surface_reach.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "geometry/region_index.h"

namespace vrc {
namespace {

constexpr double kMargin = 1.05;
constexpr double kDeviationMargin = 0.01;  // normals may be turned a little towards the viewer
constexpr std::size_t kMaxFaces = 1 << 14;
constexpr std::size_t kMaxMeasuredFaces = 1 << 10;

}  // namespace

SurfaceEllipse surface_ellipse(const Scene& scene, const SurfacePoint& point, const ValidRegion& region,
                               double support) {
  SurfaceEllipse ellipse;
  ellipse.face = point.triangle - scene.first_triangle(scene.surface_of(point.triangle));
  const double u = static_cast<double>(point.u), v = static_cast<double>(point.v);
  ellipse.barycentric = Vec3(1.0 - u - v, u, v);
  // The eigenvectors may form a left-handed pair; the walk unfolds in a right-handed one.
  ellipse.frame = {region.axis1, region.normal.cross(region.axis1), region.normal};
  ellipse.radii = support * Vec2(region.radius1, region.radius2);
  return ellipse;
}

std::vector<std::uint32_t> make_hash_slots(std::span<const std::uint32_t> numbers) {
  std::vector<std::uint32_t> slots(std::bit_ceil(std::max<std::size_t>(4, 2 * numbers.size())),
                                   kInvalidIndex);
  const auto mask = static_cast<std::uint32_t>(slots.size() - 1);
  for (const std::uint32_t number : numbers) {
    std::uint32_t i = first_hash_slot(number) & mask;
    while (slots[i] != kInvalidIndex && slots[i] != number) i = (i + 1) & mask;
    slots[i] = number;
  }
  return slots;
}

SurfaceReach reach_over_surface(const SceneCharts& charts, const SurfacePoint& point,
                                const ValidRegion& region, double support) {
  const Scene& scene = charts.scene();
  const std::size_t surface = scene.surface_of(point.triangle);
  SurfaceWalkOptions options;
  options.max_faces = kMaxFaces;
  const double turn = std::acos(region.cos_max_deviation);
  options.max_deviation = turn + kDeviationMargin;
  options.measure_deviation = false;
  // The weight of eq. 14 is positive up to k = 1 / k_r, and takes the tangent projection of a distance,
  // which on an arc is shorter than what the walk measures along the surface.
  const double arc = turn / std::max(std::sin(turn), 1e-3);
  const SurfaceEllipse ellipse = surface_ellipse(
      scene, point, region, kMargin * std::max(arc, 1.0) * support / region.cos_max_deviation);
  const SurfaceWalk walk = walk_surface(scene.surface_mesh(surface), ellipse, options);

  SurfaceReach reach;
  std::size_t faces = 0;
  for (const PatchFootprint& f : patch_footprints(charts.atlas(surface), walk, ellipse.radii, 0)) {
    const std::uint32_t patch = charts.first_patch(surface) + f.patch;
    reach.boxes.push_back({patch, f.low, f.high});
    faces += charts.face_count(patch);
  }
  if (walk.faces.size() != faces) {
    std::vector<std::uint32_t> triangles;
    triangles.reserve(walk.faces.size());
    for (const WalkedFace& f : walk.faces) triangles.push_back(scene.first_triangle(surface) + f.face);
    reach.slots = make_hash_slots(triangles);
  }
  return reach;
}

double walked_deviation(const SceneCharts& charts, const SurfacePoint& point, const ValidRegion& region) {
  const Scene& scene = charts.scene();
  const std::size_t surface = scene.surface_of(point.triangle);
  SurfaceWalkOptions options;
  options.max_faces = kMaxMeasuredFaces;
  return walk_surface(scene.surface_mesh(surface), surface_ellipse(scene, point, region, 1.0), options)
      .normal_deviation;
}

}  // namespace vrc
