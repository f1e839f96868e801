// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/image.h"

namespace vrc {

using ChannelIndices = std::array<std::size_t, 3>;

inline ChannelIndices rgb_channels(const Image& image, std::string_view layer) {
  ChannelIndices indices{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string letter(1, "RGB"[c]);
    const std::string name = layer.empty() ? letter : std::string(layer) + "." + letter;
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    if (found == image.channels.end()) {
      throw InputError(fmt::format("an image has no channel '{}'; its channels are {}", name,
                                   fmt::join(image.channels, ", ")));
    }
    indices[c] = static_cast<std::size_t>(found - image.channels.begin());
  }
  return indices;
}

inline void require_same_size(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) {
    throw InputError(fmt::format("the images differ in size: {}x{} and {}x{}; compare pictures of one size",
                                 a.width, a.height, b.width, b.height));
  }
}

/// The red, green and blue values of one layer, addressed by pixel number.
class RgbView {
 public:
  RgbView(const Image& image, std::string_view layer)
      : image_(&image), indices_(rgb_channels(image, layer)) {}
  [[nodiscard]] double operator()(std::size_t pixel, std::size_t channel) const {
    return image_->pixels[pixel * image_->channels.size() + indices_[channel]];
  }

 private:
  const Image* image_;
  ChannelIndices indices_;
};

}  // namespace vrc
