// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace vrc {

/// First and last of `count` unit cells [i, i + 1) that the interval meets, or those nearest to it.
inline std::pair<std::uint32_t, std::uint32_t> cell_range(double low, double high, std::uint32_t count) {
  const double last = count - 1.0;
  return {static_cast<std::uint32_t>(std::clamp(std::floor(low), 0.0, last)),
          static_cast<std::uint32_t>(std::clamp(std::floor(high), 0.0, last))};
}

}  // namespace vrc
