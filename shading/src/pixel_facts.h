// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "placement/record_maker.h"
#include "placement/tile.h"
#include "shading/interpolate.h"
#include "transport/film_sampler.h"

namespace vrc {

/// What shading finds out about a pixel beside its light.
struct PixelFacts {
  int samples = 0;
  bool sees_edge = false;
  // Of indirect light: sums over the samples, and means after `finish`.
  float luminance = 0.0f, luminance2 = 0.0f;
  float squared_error = 0.0f;   ///< Of the luminance at the samples; Interpolated16::squared_error.
  float sampling_error = 0.0f;  ///< Squared, of the samples' mean; set by `finish`.
  /// The least of its samples' smooth regions, the same all along an edge, and the normal of one of them
  /// there; -1: no sample scatters.
  std::int32_t region = -1;
  Vec3f normal = Vec3f::Zero();

  void add(const SurfacePoint16& points, const Interpolated16& light) {
    const auto sum = [&](F16 v) { return lane_sum(select(points.scatters, v, F16{})); };
    const F16 y = vrc::luminance(light.radiance);
    luminance += sum(y);
    luminance2 += sum(y * y);
    squared_error += sum(light.squared_error);
    for (int i = 0; i < kLanes; ++i) {
      if (points.scatters[i] == 0 || (region >= 0 && points.region[i] >= region)) continue;
      region = points.region[i];
      normal = Vec3f(points.normal.x[i], points.normal.y[i], points.normal.z[i]);
    }
  }
  void finish() {
    const float scale = 1.0f / static_cast<float>(std::max(samples, 1));
    for (float* sum : {&luminance, &luminance2, &squared_error}) *sum *= scale;
    // The records' predictions err together over a pixel; its samples lie in a net.
    const float spread = std::max(luminance2 - luminance * luminance, 0.0f);
    sampling_error = kErrorOfNet * spread * std::pow(scale, kNetConvergence);
  }
  /// What errors of its luminance are relative to.
  [[nodiscard]] double scale(double mean_luminance) const {
    return std::max(perceived(static_cast<double>(luminance), mean_luminance), 1e-15);
  }
  /// Squared error of the pixel's luminance.
  [[nodiscard]] float total_error() const { return squared_error + sampling_error; }

  static constexpr float kErrorOfNet = 0.3f, kNetConvergence = 1.5f;
};

/// The facts of a film's pixels are kept row by row.
[[nodiscard]] inline std::size_t facts_count(const Camera& camera) {
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}
[[nodiscard]] inline std::size_t facts_index(const Camera& camera, const Pixel& p) {
  return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(camera.width) +
         static_cast<std::size_t>(p.x);
}

}  // namespace vrc
