// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "placement/cache_options.h"
#include "placement/tile.h"

namespace vrc {

/// What records say about sixteen points. All 0 where none applies.
struct Interpolated16 {
  V3x16 radiance{};  ///< Outgoing.
  I16 open{};        ///< The points scatter, but no record reaches them.
  /// Of its luminance, estimated from how far the blended records disagree and how noisy they are.
  F16 squared_error{};
};

/// Outgoing radiance at the points of packet `packet` of the tile from the records around them [Zhao
/// eq. 13]: regions widened by `support`, points that none reaches by kWideSupport and up to the widest
/// deviation, with the polynomials as far out as `support`.
[[nodiscard]] Interpolated16 interpolate(const TileRecords& records, std::size_t packet, int taylor_order,
                                         double support = CacheOptions{}.blend_support);

}  // namespace vrc
