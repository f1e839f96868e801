// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace vrc {

/// Diverging colour map for [0, 1] (clamped), as linear RGB: from dark blue over a light grey at 0.5 to
/// dark orange. Lightness falls linearly and alike to both sides (OKLab, Ottosson 2020); blue and orange
/// stay apart in the common colour-vision deficiencies.
[[nodiscard]] Rgb map_diverging(double value);

/// A colour for a numbered part, as linear RGB; parts with close numbers differ.
[[nodiscard]] Rgb part_color(std::uint32_t part);

/// Linear RGB in 8-bit sRGB.
[[nodiscard]] std::array<std::uint8_t, 3> color8(const Rgb& linear);

}  // namespace vrc
