// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/image.h"

namespace vrc {

/// Mean structural similarity [WangEtAl2004] of the luma of two pictures of one size, whose channels R, G, B
/// are encoded for a screen, in [0, 1]: 1 for equal pictures. Gaussian window of 11 x 11 pixels with deviation
/// 1.5, cut off and weighed anew at the border; C1 = 0.01^2, C2 = 0.03^2. Throws InputError when a channel is
/// missing or the sizes differ.
[[nodiscard]] double mean_ssim(const Image& a, const Image& b);

}  // namespace vrc
