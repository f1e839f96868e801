// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/types.h"
#include "rgb_view.h"

namespace vrc {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

double relative_squared(double error_product, double reference) {
  return error_product / (reference * reference + kRelativeErrorOffset);
}

double mean_or_zero(double sum, std::size_t count) {
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

}  // namespace

ImageError compare_rgb(const Image& image, const Image& reference, std::string_view layer) {
  require_same_size(image, reference);
  const RgbView values(image, layer);
  const RgbView expected(reference, layer);
  ImageError result;
  double squared = 0.0, relative = 0.0, sum_image = 0.0, sum_reference = 0.0;
  std::size_t count = 0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = values(p, c), b = expected(p, c);
      if (!std::isfinite(a) || !std::isfinite(b)) {
        ++result.non_finite;
        continue;
      }
      const double d = a - b;
      squared += d * d;
      relative += relative_squared(d * d, b);
      sum_image += a;
      sum_reference += b;
      result.max_abs = std::max(result.max_abs, std::abs(d));
      ++count;
    }
  }
  result.mse = mean_or_zero(squared, count);
  result.rmse = std::sqrt(result.mse);
  result.relmse = mean_or_zero(relative, count);
  if (sum_image != sum_reference) result.mean_ratio = sum_image / sum_reference;
  return result;
}

double two_half_relmse(const Image& image, const Image& first_half, const Image& second_half,
                       std::string_view layer) {
  require_same_size(image, first_half);
  require_same_size(image, second_half);
  const RgbView values(image, layer);
  const RgbView first(first_half, layer);
  const RgbView second(second_half, layer);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = values(p, c), r1 = first(p, c), r2 = second(p, c);
      if (!std::isfinite(a) || !std::isfinite(r1) || !std::isfinite(r2)) continue;
      sum += relative_squared((a - r1) * (a - r2), 0.5 * (r1 + r2));
      ++count;
    }
  }
  return mean_or_zero(sum, count);
}

Image two_half_error_map(const Image& image, const Image& first_half, const Image& second_half,
                         const Image& reference) {
  for (const Image* other : {&first_half, &second_half, &reference}) require_same_size(image, *other);
  const RgbView values(image, {}), first(first_half, {}), second(second_half, {}), expected(reference, {});
  Image map(image.width, image.height, {"error"});
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double product = (values(p, c) - first(p, c)) * (values(p, c) - second(p, c));
      sum += relative_squared(product, expected(p, c));
    }
    map.pixels[p] = std::isfinite(sum) ? static_cast<float>(sum / 3.0) : kNotANumber;
  }
  return map;
}

Image relative_error_map(const Image& image, const Image& reference, std::string_view layer) {
  require_same_size(image, reference);
  const RgbView values(image, layer);
  const RgbView expected(reference, layer);
  Image map(image.width, image.height, {"error"});
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    double sum = 0.0;
    bool finite = true;
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = values(p, c), b = expected(p, c);
      finite = finite && std::isfinite(a) && std::isfinite(b);
      sum += relative_squared((a - b) * (a - b), b);
    }
    map.pixels[p] = finite ? static_cast<float>(std::sqrt(sum / 3.0)) : kNotANumber;
  }
  return map;
}

std::vector<double> percentiles(const Image& image, std::span<const double> shares) {
  std::vector<float> values;
  std::ranges::copy_if(image.pixels, std::back_inserter(values), [](float v) { return std::isfinite(v); });
  std::ranges::sort(values);
  std::vector<double> result;
  for (const double share : shares) {
    const double rank = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size());
    const auto index = static_cast<std::size_t>(std::max(std::ceil(rank) - 1.0, 0.0));
    result.push_back(values.empty() ? 0.0 : static_cast<double>(values[index]));
  }
  return result;
}

Image rgb_of(const Image& image, std::string_view layer) {
  const RgbView values(image, layer);
  Image rgb(image.width, image.height, {"R", "G", "B"});
  for (std::size_t p = 0; p < rgb.pixel_count(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) rgb.pixels[3 * p + c] = static_cast<float>(values(p, c));
  }
  return rgb;
}

Image scaled(Image image, float factor) {
  for (float& v : image.pixels) v *= factor;
  return image;
}

double mean_luminance(const Image& image) {
  const RgbView values(image, {});
  double sum = 0.0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p)
    sum += static_cast<double>(
        luminance(std::array{static_cast<float>(values(p, 0)), static_cast<float>(values(p, 1)),
                             static_cast<float>(values(p, 2))}));
  return mean_or_zero(sum, image.pixel_count());
}

Image mean_rgb(const Image& first, const Image& second, std::string_view layer) {
  require_same_size(first, second);
  const RgbView a(first, layer);
  const RgbView b(second, layer);
  Image mean(first.width, first.height, {"R", "G", "B"});
  for (std::size_t p = 0; p < mean.pixel_count(); ++p) {
    for (std::size_t c = 0; c < 3; ++c)
      mean.pixels[3 * p + c] = static_cast<float>(0.5 * (a(p, c) + b(p, c)));
  }
  return mean;
}

Image block_means(const Image& image, int size) {
  VRC_CHECK(size > 0, "block size {}", size);
  const auto blocks = [size](int length) { return length / size + (length % size != 0 ? 1 : 0); };
  Image result(blocks(image.width), blocks(image.height), image.channels);
  const std::size_t channels = image.channels.size();
  std::vector<double> sum(channels);
  for (int by = 0; by < result.height; ++by) {
    for (int bx = 0; bx < result.width; ++bx) {
      const int x0 = bx * size, x1 = std::min(image.width, x0 + size);
      const int y0 = by * size, y1 = std::min(image.height, y0 + size);
      std::fill(sum.begin(), sum.end(), 0.0);
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          for (std::size_t c = 0; c < channels; ++c) sum[c] += static_cast<double>(image.pixel(x, y)[c]);
        }
      }
      const double count = static_cast<double>(x1 - x0) * (y1 - y0);
      for (std::size_t c = 0; c < channels; ++c) result.pixel(bx, by)[c] = static_cast<float>(sum[c] / count);
    }
  }
  return result;
}

Image crop(const Image& image, int x0, int y0, int x1, int y1) {
  VRC_CHECK(0 <= x0 && x0 < x1 && x1 <= image.width && 0 <= y0 && y0 < y1 && y1 <= image.height,
            "window [{}, {}) x [{}, {}) of an image of {}x{}", x0, x1, y0, y1, image.width, image.height);
  Image result(x1 - x0, y1 - y0, image.channels);
  const std::size_t row = static_cast<std::size_t>(result.width) * image.channels.size();
  for (int y = y0; y < y1; ++y) std::copy_n(image.pixel(x0, y), row, result.pixel(0, y - y0));
  return result;
}

}  // namespace vrc
