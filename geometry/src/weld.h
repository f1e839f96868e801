// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace vrc {

struct WeldedPositions {
  std::vector<Vec3> positions;           ///< The distinct ones, by first occurrence.
  std::vector<std::uint32_t> vertex_of;  ///< Per input position: index into `positions`.
};

/// Merges equal positions (-0 equals 0); with a tolerance > 0 [world units], each position joins the
/// earliest kept position within that distance.
[[nodiscard]] WeldedPositions weld_positions(std::span<const Vec3> positions, double tolerance);

}  // namespace vrc
