// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "placement/cache_options.h"

namespace vrc {

/// Earlier methods, to compare with.
enum class Baseline {
  kNone,
  kKrivanek,     ///< Radiance caching in spherical harmonics, translational gradients [Krivanek2005].
  kWard,         ///< Irradiance caching, rotational and translational gradients [WardHeckbert1992].
  kSchwarzhaupt  ///< Irradiance caching, radii by an occlusion-aware Hessian [Schwarzhaupt2012].
};

/// The options that make the cache work like an earlier method (`budget` for kNone); error, number of
/// records, gather rays, sampler and order of the harmonics are those of `budget`.
///
/// Departures from the originals: points are taken in the order of the sampler instead of scanlines, radii
/// are bounded as ours (a pixel, a tenth of the picture), no neighbour clamping; the two errors of
/// Ward's weight are added in quadrature.
[[nodiscard]] CacheOptions baseline_options(Baseline baseline, const CacheOptions& budget);

}  // namespace vrc
