// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/tile.h"

#include <algorithm>
#include <map>

namespace vrc {

Tile empty_tile(const TileLayout& layout, std::size_t index) {
  Tile tile;
  const int column = static_cast<int>(index) % layout.columns(),
            row = static_cast<int>(index) / layout.columns();
  tile.x0 = layout.x0 + column * kTileSize;
  tile.y0 = layout.y0 + row * kTileSize;
  tile.x1 = std::min(tile.x0 + kTileSize, layout.x1);
  tile.y1 = std::min(tile.y0 + kTileSize, layout.y1);
  return tile;
}

Tile trace_tile(const Scene& scene, const FilmSampler& film, const TileLayout& layout, std::size_t index,
                const PacketRange& range, RayCounts& counts) {
  Tile tile = empty_tile(layout, index);
  tile.packets_per_pixel = range.count;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      for (int k = 0; k < range.count; ++k) {
        tile.packets.push_back(film.packet(x, y, range.first + k));
        const CameraPacket& packet = tile.packets.back();
        tile.points.push_back(
            scene.intersect(packet.active, film.ray(packet), RayTracer::Coherence::kCoherent));
        counts.camera += lane_count(packet.active);
      }
    }
  }
  return tile;
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
}

bool TileRecords::may_reach(const PackedRecord& record, const SurfacePoint16& p, float support) {
  const V3x16 d = p.position - splat3(record.center);
  // The weight of eq. 14 is positive up to k = 1 / k_r.
  const float reach = record.reach * support / record.cos_max_deviation;
  return any((dot(d, d) < reach * reach) & p.scatters);
}

}  // namespace vrc
