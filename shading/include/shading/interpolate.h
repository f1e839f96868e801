// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "placement/cache_options.h"
#include "placement/tile.h"

namespace vrc {

/// Outgoing radiance at the points of packet `packet` of the tile from the records around them [Zhao
/// eq. 13]: regions widened by `support`, points that none reaches by kWideSupport; 0 where nothing
/// applies.
[[nodiscard]] V3x16 interpolate(const TileRecords& records, std::size_t packet, int taylor_order,
                                double support = CacheOptions{}.blend_support);

}  // namespace vrc
