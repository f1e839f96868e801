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

void add_open_samples(const TileRecords& records, const std::unordered_set<std::uint64_t>& tried,
                      TakenBlocks& blocks, std::vector<OpenSample>& result) {
  const Tile& tile = records.tile();
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const SurfacePoint16& p = tile.points[i];
    I16 open = p.scatters;
    if (any(open)) {
      records.for_each(i, static_cast<float>(kWideSupport),
                       [&](const PackedRecord&, const Coverage16& c) { open &= ~(c.weight > 0.0f); });
    }
    if (!any(open)) continue;
    const Pixel& pixel = tile.pixels[i / static_cast<std::size_t>(tile.packets_per_pixel)];
    bool& taken = blocks.at(pixel);
    for (int lane = 0; lane < kLanes && !taken; ++lane) {
      if (open[lane] == 0 || tried.contains(key_of(p, lane))) continue;
      taken = true;
      result.push_back({static_cast<std::uint32_t>(p.triangle[lane]), p.u[lane], p.v[lane], key_of(p, lane),
                        turn_of(pixel.x, pixel.y)});
    }
  }
}

}  // namespace

std::vector<OpenSample> find_open_samples(const Scene& scene, const FilmSampler& film,
                                          const RadianceCache& cache, const std::vector<Pixel>& pixels,
                                          bool supersample_edges, int block_size,
                                          const std::unordered_set<std::uint64_t>& tried, RayCounts& counts) {
  std::vector<OpenSample> result;
  TakenBlocks blocks = {block_size, pixels.front()};
  for_each_traced(scene, film, pixels, supersample_edges, counts, [&](const Tile& tile) {
    add_open_samples(TileRecords(cache, tile), tried, blocks, result);
  });
  return result;
}

}  // namespace vrc
