// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unordered_set>
#include <vector>

#include "placement/place_records.h"
#include "placement/tile.h"

namespace vrc {

/// A camera sample's surface point that no record reaches.
struct OpenSample {
  std::uint32_t triangle;
  float u, v;
  std::uint64_t key;
  std::uint32_t turn;  ///< Of its pixel.
};

/// Packets of the camera samples of pixels, one for each entry of `pixels`, with lanes that no region
/// reaches, widened kWideSupport times and up to the widest deviation; only these scatter.
[[nodiscard]] Tile find_open_samples(const Scene& scene, const FilmSampler& film, const RadianceCache& cache,
                                     const std::vector<Pixel>& pixels, int further_edge_samples,
                                     RayCounts& counts);

/// Those of them that no region reaches of a cache with more records.
[[nodiscard]] Tile still_open(const RadianceCache& cache, const Tile& open);

/// At most one of a tile's open samples, whose pixels begin with `first`, for each square of `block_size`
/// pixels a side, and none whose key is among those `tried`.
[[nodiscard]] std::vector<OpenSample> choose_open_samples(const Tile& open, const Pixel& first,
                                                          int block_size,
                                                          const std::unordered_set<std::uint64_t>& tried);

}  // namespace vrc
