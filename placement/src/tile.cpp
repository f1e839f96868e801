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

TileRecords::TileRecords(const RadianceCache& cache, const Tile& tile) : cache_(cache) {
  // One box for each smooth region that the tile sees: regions at different depths stay apart.
  std::map<std::int32_t, Box3> boxes;
  for (const SurfacePoint16& p : tile.points) {
    for (std::uint32_t left = mask_bits(p.scatters); left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      boxes[p.region[i]].extend(Vec3(p.position.x[i], p.position.y[i], p.position.z[i]));
    }
  }
  for (const auto& [region, box] : boxes) {
    const std::size_t first = candidates_.size();
    cache.find(box, candidates_);
    const auto begin = candidates_.begin() + static_cast<std::ptrdiff_t>(first);
    candidates_.erase(
        std::remove_if(begin, candidates_.end(),
                       [&, id = region](std::uint32_t i) { return cache.packed()[i].region != id; }),
        candidates_.end());
  }
}

bool TileRecords::may_reach(const PackedRecord& record, const SurfacePoint16& p, float support) {
  const V3x16 d = p.position - splat3(record.center);
  // The weight of eq. 14 is positive up to k = 1 / k_r.
  const float reach = record.reach * support / record.cos_max_deviation;
  return any((dot(d, d) < reach * reach) & (p.region == record.region));
}

}  // namespace vrc
