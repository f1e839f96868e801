// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/pixel_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/hash.h"
#include "core/parallel.h"

namespace vrc {
namespace {

/// Morton code with its bits reversed: sorts a square of 2^levels pixels coarse to fine.
std::uint64_t coarse_to_fine_key(std::uint32_t x, std::uint32_t y, int levels) {
  std::uint64_t key = 0;
  for (int bit = 0; bit < levels; ++bit) {
    key = (key << 2) | (((x >> bit) & 1u) ^ ((y >> bit) & 1u)) << 1 | ((y >> bit) & 1u);
  }
  return key;
}

}  // namespace

PixelGrid::PixelGrid(const Scene& scene, const PlacementView& view, std::uint64_t& camera_rays)
    : camera_(scene.camera()),
      x0_(view.x0),
      y0_(view.y0),
      width_(view.x1 - view.x0),
      height_(view.y1 - view.y0) {
  const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  points_.resize(count);
  covered_.assign(count, 0);
  parallel_for(static_cast<std::size_t>(height_), [&](std::size_t row) {
    for (int begin = 0; begin < width_; begin += kLanes) {
      const I16 x = lane_index() + begin;
      const F16 film_x = to_float(x) + (static_cast<float>(x0_) + 0.5f);
      const F16 film_y = splat(static_cast<float>(y0_) + static_cast<float>(row) + 0.5f);
      const Ray16 ray = {splat3(camera_.origin), camera_directions(camera_, film_x, film_y), splat(1e17f)};
      const SurfacePoint16 p = scene.intersect(x < width_, ray, RayTracer::Coherence::kCoherent);
      for (int i = 0; i < std::min(kLanes, width_ - begin); ++i) {
        Point& point = points_[row * static_cast<std::size_t>(width_) + static_cast<std::size_t>(begin + i)];
        point.scatters = p.scatters[i] != 0;
        point.position = {p.position.x[i], p.position.y[i], p.position.z[i]};
        point.normal = {p.normal.x[i], p.normal.y[i], p.normal.z[i]};
        point.region = p.region[i];
        point.triangle = static_cast<std::uint32_t>(p.triangle[i]);
        point.u = p.u[i];
        point.v = p.v[i];
      }
    }
  });
  camera_rays += count;

  const int levels = std::bit_width(static_cast<unsigned>(std::max(width_, height_) - 1));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<std::uint32_t>(i % static_cast<std::size_t>(width_));
    const auto y = static_cast<std::uint32_t>(i / static_cast<std::size_t>(width_));
    keyed[i] = {coarse_to_fine_key(x, y, levels), static_cast<std::uint32_t>(i)};
  }
  std::ranges::sort(keyed);
  order_.reserve(count);
  for (const auto& [key, index] : keyed) order_.push_back(index);
}

std::size_t PixelGrid::lattice_prefix(int stride) const {
  const auto along = [&](int extent) { return static_cast<std::size_t>((extent + stride - 1) / stride); };
  return along(width_) * along(height_);
}

std::optional<SurfacePoint> PixelGrid::surface_point(const Scene& scene, std::size_t pixel) const {
  const Point& p = points_[pixel];
  if (!p.scatters) return std::nullopt;
  return scene.surface_point(p.triangle, p.u, p.v, camera_.origin);
}

std::uint64_t PixelGrid::key(std::size_t pixel) const {
  const std::size_t x = pixel % static_cast<std::size_t>(width_) + static_cast<std::size_t>(x0_);
  const std::size_t y = pixel / static_cast<std::size_t>(width_) + static_cast<std::size_t>(y0_);
  return hash(0x9121u, x, y);
}

PixelGrid::PixelRect PixelGrid::footprint(const ValidRegion& region) const {
  const PixelRect everything = {0, 0, width_, height_};
  double lo_x = 1e30, lo_y = 1e30, hi_x = -1e30, hi_y = -1e30;
  // The corners of a box around the ellipsoid: their hull's projection holds the ellipsoid's.
  for (int corner = 0; corner < 8; ++corner) {
    const auto sign = [&](int bit) { return (corner >> bit) & 1 ? 1.0 : -1.0; };
    const Vec3 p = region.center + sign(0) * region.radius1 * region.axis1 +
                   sign(1) * region.radius2 * region.axis2 + sign(2) * region.normal_radius * region.normal;
    const Vec3 d = p - camera_.origin;
    const double depth = d.dot(camera_.forward);
    if (depth <= 1e-3 * d.norm()) return everything;
    const double scale = camera_.width / (2.0 * camera_.tan_half_width * depth);
    const double x = 0.5 * camera_.width + scale * d.dot(camera_.right);
    const double y = 0.5 * camera_.height - scale * d.dot(camera_.up);
    lo_x = std::min(lo_x, x);
    hi_x = std::max(hi_x, x);
    lo_y = std::min(lo_y, y);
    hi_y = std::max(hi_y, y);
  }
  const auto clamp = [](double v, int limit) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(limit)));
  };
  return {clamp(lo_x - x0_ - 1.0, width_), clamp(lo_y - y0_ - 1.0, height_), clamp(hi_x - x0_ + 2.0, width_),
          clamp(hi_y - y0_ + 2.0, height_)};
}

void PixelGrid::cover(const ValidRegion& region, std::int32_t smooth_region) {
  const PixelRect rect = footprint(region);
  const Vec3f center = region.center.cast<float>(), normal = region.normal.cast<float>();
  const Vec3f a = (region.axis1 / region.radius1).cast<float>(),
              b = (region.axis2 / region.radius2).cast<float>();
  const Vec3f c = (region.normal / region.normal_radius).cast<float>();
  const auto inverse_deviation = static_cast<float>(1.0 / std::max(1.0 - region.cos_max_deviation, 1e-12));
  for (int y = rect.y0; y < rect.y1; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (int x = rect.x0; x < rect.x1; ++x) {
      const Point& p = points_[row + static_cast<std::size_t>(x)];
      if (p.region != smooth_region || covered_[row + static_cast<std::size_t>(x)]) continue;
      const Vec3f d = p.position - center;
      const float ka = d.dot(a), kb = d.dot(b), kc = d.dot(c);
      const float turn = std::max(0.0f, 1.0f - p.normal.dot(normal)) * inverse_deviation;
      if (ka * ka + kb * kb + kc * kc + turn < 1.0f) {
        covered_[row + static_cast<std::size_t>(x)] = 1;
      }
    }
  }
}

void PixelGrid::clear_coverage() { std::ranges::fill(covered_, std::uint8_t{0}); }

}  // namespace vrc
