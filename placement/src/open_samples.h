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

/// Samples of a tile's pixels that no region reaches, widened kWideSupport times; at most one for each square
/// of `block_size` pixels a side, and none whose key is among those `tried`.
[[nodiscard]] std::vector<OpenSample> find_open_samples(const Scene& scene, const FilmSampler& film,
                                                        const RadianceCache& cache,
                                                        const std::vector<Pixel>& pixels,
                                                        bool supersample_edges, int block_size,
                                                        const std::unordered_set<std::uint64_t>& tried,
                                                        RayCounts& counts);

}  // namespace vrc
