// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "placement/tile.h"

namespace vrc {

/// Outgoing radiance at sixteen points from the records around them [Zhao eq. 13]: regions widened
/// by kBlendSupport, points that none reaches by kWideSupport; 0 where nothing applies.
[[nodiscard]] V3x16 interpolate(const TileRecords& records, const SurfacePoint16& p, int taylor_order);

}  // namespace vrc
