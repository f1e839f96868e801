// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/error.h"

namespace vrc {

/// Interleaved 32-bit float pixels, row by row from the top; linear values.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;  ///< EXR names: "R", "G", "B", "indirect.R", "N.X", "depth.Z" ...
  std::vector<float> pixels;          ///< width * height * channels.size()

  Image() = default;
  Image(int image_width, int image_height, std::vector<std::string> names)
      : width(image_width),
        height(image_height),
        channels(std::move(names)),
        pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels.size(), 0.0f) {}

  [[nodiscard]] std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] float* pixel(int x, int y) {
    return pixels.data() + (static_cast<std::size_t>(y) * width + x) * channels.size();
  }
  [[nodiscard]] const float* pixel(int x, int y) const {
    return pixels.data() + (static_cast<std::size_t>(y) * width + x) * channels.size();
  }
};

}  // namespace vrc
