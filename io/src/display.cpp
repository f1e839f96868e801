// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/display.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vrc {
namespace {

std::size_t channel_or(const Image& image, const char* name, std::size_t fallback) {
  const auto found = std::ranges::find(image.channels, name);
  if (found != image.channels.end()) return static_cast<std::size_t>(found - image.channels.begin());
  return std::min(fallback, image.channels.size() - 1);
}

/// In [0, 1], infinities like any large value; NaN stays.
float clamped(float v) { return std::isnan(v) ? v : std::clamp(v, 0.0f, 1.0f); }

float aces(float x) {
  if (!std::isfinite(x)) return x;
  const float v = std::max(x, 0.0f);
  if (v > 1e6f) return 1.0f;
  return v * (2.51f * v + 0.03f) / (v * (2.43f * v + 0.59f) + 0.14f);
}

}  // namespace

Rgb displayed(const Rgb& radiance, const Display& display) {
  const Rgb exposed = radiance * static_cast<float>(std::exp2(display.exposure));
  switch (display.tonemap) {
    case Tonemap::kNone:
      break;
    case Tonemap::kReinhard: {
      const float y = luminance(exposed);
      if (std::isfinite(y) && y > 0.0f) return exposed / (1.0f + y);
      break;
    }
    case Tonemap::kAces:
      return exposed.unaryExpr(&aces);
  }
  return exposed;
}

Image displayed(const Image& image, const Display& display) {
  Image result(image.width, image.height, {"R", "G", "B"});
  const std::array<std::size_t, 3> rgb{channel_or(image, "R", 0), channel_or(image, "G", 1),
                                       channel_or(image, "B", 2)};
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    const float* values = image.pixels.data() + p * image.channels.size();
    const Rgb shown = displayed(Rgb(values[rgb[0]], values[rgb[1]], values[rgb[2]]), display);
    for (std::size_t c = 0; c < 3; ++c)
      result.pixels[3 * p + c] = clamped(shown[static_cast<Eigen::Index>(c)]);
  }
  return result;
}

}  // namespace vrc
