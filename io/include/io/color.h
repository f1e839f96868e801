// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace vrc {

/// Transfer functions of IEC 61966-2-1 for values in [0, 1]; values outside are clamped.
[[nodiscard]] float srgb_from_linear(float linear);
[[nodiscard]] float linear_from_srgb(float encoded);

/// 0 to 255, rounded to nearest; NaN becomes 0.
[[nodiscard]] std::uint8_t quantize8(float value);

/// Colour map for scalars in [0, 1] (clamped), as linear RGB: from dark violet over blue and teal to
/// yellow. Its lightness rises steadily, so it also reads without colour vision and in grey.
[[nodiscard]] Rgb map_color(double value);

/// `map_color` in 8-bit sRGB.
[[nodiscard]] std::array<std::uint8_t, 3> map_color8(double value);

}  // namespace vrc
