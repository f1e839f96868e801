// SPDX-License-Identifier: GPL-3.0-or-later
#include "error_colors.h"

#include <cmath>
#include <limits>

#include "core/image_error.h"
#include "io/color.h"

namespace vrc {

Image error_colors(const Image& image, const Image& reference) {
  const Image error = relative_error_map(image, reference);
  Image colors(error.width, error.height, {"R", "G", "B"});
  for (std::size_t p = 0; p < error.pixel_count(); ++p) {
    const double e = static_cast<double>(error.pixels[p]);
    const Rgb color = std::isnan(e) ? Rgb::Constant(std::numeric_limits<float>::quiet_NaN()).eval()
                                    : map_color((std::log10(e) + 3.0) / 3.0);
    for (std::size_t c = 0; c < 3; ++c) colors.pixels[3 * p + c] = color[static_cast<Eigen::Index>(c)];
  }
  return colors;
}

Image encoded(const Image& image, const Display& display) {
  Image result = displayed(image, display);
  for (float& v : result.pixels) v = srgb_from_linear(v);
  return result;
}

}  // namespace vrc
