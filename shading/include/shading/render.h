// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/run_control.h"
#include "core/timing.h"
#include "placement/cache_options.h"
#include "placement/place_records.h"
#include "transport/scene.h"

namespace vrc {

enum class Method { kCache, kPath, kDirect };
enum class Component { kFull, kDirect, kIndirect };

/// Pixels [x0, x1) x [y0, y1) of the film.
struct CropWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct RenderOptions {
  Method method = Method::kCache;
  Component only = Component::kFull;
  int bounces = 1;  ///< Indirect bounces: 0 is direct light only; -1 is unbounded.
  int samples_per_pixel = 16;
  int light_samples = 0;  ///< Of the direct light, per camera sample; 0 chooses by method.
  std::uint64_t seed = 0;
  std::optional<CropWindow> crop;  ///< Pixels outside stay black.
  /// With Method::kPath: > 0 sends that many guided rays for the indirect light of a pixel from the points
  /// of its samples, at least 256 from each sixteen, rounded up to a power of two; 0: a path from each
  /// sample.
  int path_rays = 0;
  /// With Method::kCache: > 0 is the wall-clock time to take, in the place of the cache's `error`. The clock
  /// then decides what is rendered: pictures differ from run to run.
  double seconds = 0.0;
  bool aovs = false;  ///< Adds the layers albedo, N and depth.
  bool shade = true;  ///< false: records are placed, the picture stays black.
  CacheOptions cache;
};

struct RenderStats {
  std::vector<PhaseTime> phases;
  std::uint64_t records = 0;       ///< In the cache.
  std::uint64_t records_made = 0;  ///< For this picture.
  std::uint64_t gather_rays = 0;   ///< Rays from records to find their surroundings.
  std::uint64_t shadow_rays = 0;
  std::uint64_t camera_rays = 0;
  std::uint64_t other_rays = 0;   ///< Bounces of paths.
  std::uint64_t hard_pixels = 0;  ///< Gathered again, as records show them badly.
  int light_samples = 0;          ///< Of direct light, for each camera sample; a short time leaves one.
  int edge_samples = 0;           ///< Camera samples of pixels with edges; likewise those of others.
  double error = 0.0;             ///< Accepted; 0: their time or number says how many records there are.
  double records_error = 0.0;     ///< That records were placed for; 0: there are as many as were wanted.
  double relative_error = 0.0;    ///< Estimated, of the indirect light: HardPixels.
  bool unfinished = false;        ///< Interrupted: the picture holds what there was.
};

/// The picture with channels R, G, B (the chosen component), then direct.{R,G,B} and
/// indirect.{R,G,B}, then with `aovs` albedo.{R,G,B}, N.{X,Y,Z} and depth.Z.
struct RenderResult {
  Image image;
  RenderStats stats;
  std::optional<RadianceCache> cache;  ///< With Method::kCache.
  PictureScale scale;                  ///< Likewise.
};

/// Same bytes for the same scene, options and seed, at any thread count, unless `seconds` are given.
/// `earlier` frames of a fly-through through the same scene leave their records.
[[nodiscard]] RenderResult render(const Scene& scene, const RenderOptions& options,
                                  const RunControl& control = {}, const EarlierFrames& earlier = {});

}  // namespace vrc
