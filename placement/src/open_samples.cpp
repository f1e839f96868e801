// SPDX-License-Identifier: GPL-3.0-or-later
#include "open_samples.h"

#include <array>
#include <bit>

#include "core/hash.h"

namespace vrc {
namespace {

/// The square blocks of a tile that have their sample.
struct TakenBlocks {
  int size;  ///< Pixels.
  Pixel first;
  std::array<bool, std::size_t{kTileSize} * kTileSize> taken{};

  [[nodiscard]] bool& at(const Pixel& pixel) {
    return taken[static_cast<std::size_t>((pixel.y - first.y) / size * kTileSize +
                                          (pixel.x - first.x) / size)];
  }
};

std::uint64_t key_of(const SurfacePoint16& p, int lane) {
  return hash(0x5a3u, p.triangle[lane], std::bit_cast<std::uint32_t>(float{p.u[lane]}),
              std::bit_cast<std::uint32_t>(float{p.v[lane]}));
}

/// Lanes of a packet of the records' tile that no region reaches.
I16 open_lanes(const TileRecords& records, std::size_t packet) {
  I16 open = records.tile().points[packet].scatters;
  if (!any(open)) return open;
  records.for_each_while(packet, static_cast<float>(kWideSupport), Deviation::kWidest,
                         [&](const PackedRecord&, const Coverage16& c) {
                           open &= ~(c.weight > 0.0f);
                           return any(open);
                         });
  return open;
}

/// Appends the packets that have open lanes, which alone scatter then.
void add_open(const TileRecords& records, Tile& result) {
  const Tile& tile = records.tile();
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const I16 open = open_lanes(records, i);
    if (!any(open)) continue;
    result.pixels.push_back(tile.pixels[i / static_cast<std::size_t>(tile.packets_per_pixel)]);
    result.points.push_back(tile.points[i]);
    result.points.back().scatters = open;
  }
}

}  // namespace

Tile find_open_samples(const Scene& scene, const FilmSampler& film, const RadianceCache& cache,
                       const std::vector<Pixel>& pixels, int further_edge_samples, RayCounts& counts) {
  Tile result;
  for_each_traced(scene, film, pixels, further_edge_samples, counts,
                  [&](const Tile& tile) { add_open(TileRecords(cache, tile), result); });
  return result;
}

Tile still_open(const RadianceCache& cache, const Tile& open) {
  Tile result;
  add_open(TileRecords(cache, open), result);
  return result;
}

std::vector<OpenSample> choose_open_samples(const Tile& open, const Pixel& first, int block_size,
                                            const std::unordered_set<std::uint64_t>& tried) {
  TakenBlocks blocks = {block_size, first};
  std::vector<OpenSample> result;
  for (std::size_t i = 0; i < open.points.size(); ++i) {
    const SurfacePoint16& p = open.points[i];
    const Pixel& pixel = open.pixels[i];
    bool& taken = blocks.at(pixel);
    for (int lane = 0; lane < kLanes && !taken; ++lane) {
      if (p.scatters[lane] == 0 || tried.contains(key_of(p, lane))) continue;
      taken = true;
      result.push_back({static_cast<std::uint32_t>(p.triangle[lane]), p.u[lane], p.v[lane], key_of(p, lane),
                        turn_of(pixel.x, pixel.y)});
    }
  }
  return result;
}

}  // namespace vrc
