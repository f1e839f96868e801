// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/tile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace vrc {

std::vector<Pixel> pixels_of(const TileLayout& layout, std::size_t index) {
  const int column = static_cast<int>(index) % layout.columns(),
            row = static_cast<int>(index) / layout.columns();
  const int x0 = layout.x0 + column * kTileSize, y0 = layout.y0 + row * kTileSize;
  std::vector<Pixel> pixels;
  for (int y = y0; y < std::min(y0 + kTileSize, layout.y1); ++y) {
    for (int x = x0; x < std::min(x0 + kTileSize, layout.x1); ++x) pixels.push_back({x, y});
  }
  return pixels;
}

Tile trace_tile(const Scene& scene, const FilmSampler& film, std::vector<Pixel> pixels,
                const PacketRange& range, RayCounts& counts) {
  Tile tile;
  tile.pixels = std::move(pixels);
  tile.packets_per_pixel = range.count;
  for (const Pixel& pixel : tile.pixels) {
    for (int k = 0; k < range.count; ++k) {
      tile.packets.push_back(film.packet(pixel.x, pixel.y, range.first + k));
      const CameraPacket& packet = tile.packets.back();
      tile.points.push_back(
          scene.intersect(packet.active, film.ray(packet), RayTracer::Coherence::kCoherent));
      counts.camera += lane_count(packet.active);
    }
  }
  return tile;
}

bool sees_edge(const Tile& tile, std::size_t pixel) {
  const auto count = static_cast<std::size_t>(tile.packets_per_pixel);
  const SurfacePoint16& first = tile.points[pixel * count];
  const int lane = first_lane(tile.packets[pixel * count].active);
  for (std::size_t i = pixel * count; i < (pixel + 1) * count; ++i) {
    const SurfacePoint16& p = tile.points[i];
    const I16 differs = (p.hit != first.hit[lane]) | (p.scatters != first.scatters[lane]);
    const I16 turned = (p.region != first.region[lane]) |
                       (p.normal.x * first.normal.x[lane] + p.normal.y * first.normal.y[lane] +
                            p.normal.z * first.normal.z[lane] <
                        kCosEdgeTurn);
    if (any(tile.packets[i].active & (differs | (turned & p.hit)))) return true;
  }
  return false;
}

TileRecords::TileRecords(const RadianceCache& cache, const Tile& tile) : cache_(cache), tile_(tile) {
  std::map<std::uint32_t, Eigen::AlignedBox2f> boxes;  // by patch
  at_.reserve(tile.points.size());
  for (const SurfacePoint16& p : tile.points) {
    at_.push_back(cache.charts().locate(p.scatters, p.triangle, p.u, p.v));
    const ChartPoint16& at = at_.back();
    for_each_distinct(at.patch >= 0, at.patch, [&](I16 mask, std::size_t patch) {
      const float infinity = std::numeric_limits<float>::infinity();
      const auto low = [&](F16 x) { return lane_min(select(mask, x, splat(infinity))); };
      const auto high = [&](F16 x) { return lane_max(select(mask, x, splat(-infinity))); };
      boxes[static_cast<std::uint32_t>(patch)].extend(
          Eigen::AlignedBox2f(Vec2f(low(at.u), low(at.v)), Vec2f(high(at.u), high(at.v))));
    });
  }
  for (const auto& [patch, box] : boxes) {
    // Points are located in single precision.
    const Vec2f slack = Vec2f::Constant(1e-6f * (box.min().cwiseAbs() + box.max().cwiseAbs()).maxCoeff());
    cache.find(patch, (box.min() - slack).cast<double>(), (box.max() + slack).cast<double>(), candidates_);
  }
  std::ranges::sort(candidates_);
  Spheres16 none;
  none.radius = splat(-1.0f);
  spheres_.resize((candidates_.size() + kLanes - 1) / kLanes, none);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const PackedRecord& record = cache.packed()[cache.footprints()[candidates_[i]].record];
    Spheres16& s = spheres_[i / kLanes];
    const auto lane = static_cast<int>(i % kLanes);
    s.center.x[lane] = record.center[0];
    s.center.y[lane] = record.center[1];
    s.center.z[lane] = record.center[2];
    s.radius[lane] = reach_of(record);
  }
}

TileRecords::Sphere TileRecords::bounds(const SurfacePoint16& p) {
  const float infinity = std::numeric_limits<float>::infinity();
  const auto middle = [&](F16 x) {
    const float low = lane_min(select(p.scatters, x, splat(infinity)));
    const float high = lane_max(select(p.scatters, x, splat(-infinity)));
    return low <= high ? 0.5f * (low + high) : 0.0f;
  };
  const Vec3f center(middle(p.position.x), middle(p.position.y), middle(p.position.z));
  const V3x16 d = p.position - splat3(center);
  return {center, std::sqrt(lane_max(select(p.scatters, dot(d, d), F16{})))};
}

/// The weight of eq. 14 is positive up to k = 1 / k_r.
float TileRecords::reach_of(const PackedRecord& record) { return record.reach / record.cos_widest_deviation; }

bool TileRecords::may_reach(const PackedRecord& record, const SurfacePoint16& p, float support) {
  const V3x16 d = p.position - splat3(record.center);
  const float reach = reach_of(record) * support;
  return any((dot(d, d) < reach * reach) & p.scatters);
}

}  // namespace vrc
