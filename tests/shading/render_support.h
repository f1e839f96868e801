// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>

#include "core/image_error.h"
#include "io/scene_reader.h"
#include "shading/render.h"

namespace vrc::test {

inline SceneDescription describe_scene(const std::string& name, int width, int height,
                                       const std::map<std::string, std::string>& defines = {}) {
  SceneReadOptions options;
  options.defines = defines;
  options.width = width;
  options.height = height;
  return read_scene(std::string(VRC_SOURCE_DIR "/scenes/") + name, options);
}

inline Scene load_scene(const std::string& name, int width, int height,
                        const std::map<std::string, std::string>& defines = {}) {
  return Scene(describe_scene(name, width, height, defines));
}

inline RenderOptions options_of(Method method, int samples_per_pixel, std::uint64_t seed = 1,
                                Component only = Component::kFull) {
  RenderOptions options;
  options.method = method;
  options.only = only;
  options.samples_per_pixel = samples_per_pixel;
  options.seed = seed;
  return options;
}

/// Two references for indirect light by path tracing, or by guided rays of the pixels, scaled to a mean
/// luminance of one half.
struct IndirectReference {
  std::array<Image, 2> halves;
  float scale = 1.0f;

  IndirectReference(const Scene& scene, int samples_per_pixel, int path_rays = 0) {
    double sum = 0.0;
    for (std::size_t half = 0; half < 2; ++half) {
      RenderOptions options = options_of(Method::kPath, samples_per_pixel, 1000 + half, Component::kIndirect);
      options.path_rays = path_rays;
      halves[half] = render(scene, options).image;
      for (std::size_t p = 0; p < halves[half].pixel_count(); ++p) {
        const float* v = halves[half].pixels.data() + p * halves[half].channels.size();
        sum += static_cast<double>(luminance(std::array{v[0], v[1], v[2]}));
      }
    }
    scale = static_cast<float>(static_cast<double>(halves[0].pixel_count()) / sum);
    for (Image& half : halves) {
      for (float& v : half.pixels) v *= scale;
    }
  }

  [[nodiscard]] double relmse(Image image) const {
    for (float& v : image.pixels) v *= scale;
    return two_half_relmse(image, halves[0], halves[1]);
  }
  /// Mean of the image over that of the reference.
  [[nodiscard]] double mean_ratio(Image image) const {
    for (float& v : image.pixels) v *= scale;
    return compare_rgb(image, mean_rgb(halves[0], halves[1])).mean_ratio;
  }
};

}  // namespace vrc::test
