// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/image.h"
#include "io/display.h"

namespace vrc {

/// The relative error of each pixel as linear colours: from dark violet (0.001 and below) to yellow (1 and
/// above), a factor of ten for each third of the map; pixels that are not finite are NaN.
[[nodiscard]] Image error_colors(const Image& image, const Image& reference);

/// `displayed`, with the curve of sRGB: what `mean_ssim` compares.
[[nodiscard]] Image encoded(const Image& image, const Display& display);

}  // namespace vrc
