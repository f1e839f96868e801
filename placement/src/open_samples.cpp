// SPDX-License-Identifier: GPL-3.0-or-later
#include "open_samples.h"

#include <array>
#include <bit>

#include "core/hash.h"

namespace vrc {
namespace {

using TakenBlocks = std::array<bool, (kTileSize / 2) * (kTileSize / 2)>;

void add_open_samples(const TileRecords& records, TakenBlocks& taken, std::vector<OpenSample>& result) {
  const Tile& tile = records.tile();
  const auto row = static_cast<std::size_t>(tile.x1 - tile.x0);
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const SurfacePoint16& p = tile.points[i];
    I16 open = p.scatters;
    if (any(open)) {
      records.for_each(i, static_cast<float>(kWideSupport),
                       [&](const PackedRecord&, const Coverage16& c) { open &= ~(c.weight > 0.0f); });
    }
    if (!any(open)) continue;
    const std::size_t pixel = i / static_cast<std::size_t>(tile.packets_per_pixel);
    bool& block = taken[(pixel / row / 2) * (kTileSize / 2) + (pixel % row) / 2];
    if (block) continue;
    block = true;
    const int lane = first_lane(open);
    const std::uint64_t key = hash(0x5a3u, p.triangle[lane], std::bit_cast<std::uint32_t>(float{p.u[lane]}),
                                   std::bit_cast<std::uint32_t>(float{p.v[lane]}));
    result.push_back({static_cast<std::uint32_t>(p.triangle[lane]), p.u[lane], p.v[lane], key});
  }
}

}  // namespace

std::vector<OpenSample> find_open_samples(const Scene& scene, const FilmSampler& film,
                                          const RadianceCache& cache, const TileLayout& layout,
                                          std::size_t tile, RayCounts& counts) {
  std::vector<OpenSample> result;
  TakenBlocks taken{};
  for_each_range(film, [&](const PacketRange& range) {
    const Tile traced = trace_tile(scene, film, layout, tile, range, counts);
    add_open_samples(TileRecords(cache, traced), taken, result);
  });
  return result;
}

}  // namespace vrc
