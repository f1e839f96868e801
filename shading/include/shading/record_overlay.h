// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/image.h"
#include "placement/radiance_cache.h"

namespace vrc {

struct RecordOverlayOptions {
  double scale = 0.5;                        ///< Of the drawn ellipses to the valid regions, which overlap.
  double line_width = 1.2;                   ///< [pixels]
  double dot_radius = 1.3;                   ///< Of the centres, smaller likewise. [pixels]
  Rgb taylor_color{0.093f, 0.456f, 0.815f};  ///< Linear.
  Rgb harmonics_color{0.791f, 0.112f, 0.0f};
};

/// The picture, channels R, G, B cut off to [0, 1], and over it the rims
/// of the records' ellipses, as they lie on the surface, and their centres: in one colour Taylor records
/// and over them, in the other, those of spherical harmonics. What the camera does not see is left out. The
/// time grows with the pixels that are drawn.
[[nodiscard]] Image draw_record_overlay(const Image& picture, const RadianceCache& cache,
                                        const RecordOverlayOptions& options = {});

}  // namespace vrc
