// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/image.h"
#include "core/types.h"

namespace vrc {

enum class Tonemap {
  kNone,      ///< What exceeds 1 is cut off.
  kReinhard,  ///< c / (1 + Y), Y the luminance [Reinhard2002, eq. 3].
  kAces       ///< Narkowicz's fit of the ACES film curve, channel by channel [Narkowicz2016].
};

/// How radiance is brought to a screen.
struct Display {
  double exposure = 0.0;  ///< Powers of two that it is brightened by first.
  Tonemap tonemap = Tonemap::kNone;
};

/// Linear light of the screen for linear radiance. NaN stays NaN.
[[nodiscard]] Rgb displayed(const Rgb& radiance, const Display& display);
/// Channels R, G, B of a picture (or its first three), each in [0, 1] or NaN.
[[nodiscard]] Image displayed(const Image& image, const Display& display);

}  // namespace vrc
