// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image_structure.h"

#include <array>
#include <cmath>
#include <vector>

#include "core/types.h"
#include "rgb_view.h"

namespace vrc {
namespace {

constexpr int kRadius = 5;
constexpr double kDeviation = 1.5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

/// A value for each pixel.
struct Plane {
  int width, height;
  std::vector<double> values;

  [[nodiscard]] double& at(int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; }
  [[nodiscard]] double at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
};

Plane luma(const Image& image) {
  const RgbView rgb(image, {});
  Plane plane{image.width, image.height, std::vector<double>(image.pixel_count())};
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = rgb(p, c);
      plane.values[p] += kLuminance[c] * (std::isfinite(value) ? value : 0.0);
    }
  }
  return plane;
}

std::array<double, kRadius + 1> gaussian() {
  std::array<double, kRadius + 1> weights{};
  for (int i = 0; i <= kRadius; ++i)
    weights[static_cast<std::size_t>(i)] = std::exp(-0.5 * i * i / (kDeviation * kDeviation));
  return weights;
}

/// Weighted means over the window around every pixel: first along rows, then along columns.
Plane blurred(const Plane& plane) {
  static const auto kWeights = gaussian();
  const auto along = [](const Plane& source, int dx, int dy) {
    Plane result = source;
    for (int y = 0; y < source.height; ++y) {
      for (int x = 0; x < source.width; ++x) {
        double sum = 0.0, total = 0.0;
        for (int i = -kRadius; i <= kRadius; ++i) {
          const int px = x + i * dx, py = y + i * dy;
          if (px < 0 || px >= source.width || py < 0 || py >= source.height) continue;
          const double w = kWeights[static_cast<std::size_t>(std::abs(i))];
          sum += w * source.at(px, py);
          total += w;
        }
        result.at(x, y) = sum / total;
      }
    }
    return result;
  };
  return along(along(plane, 1, 0), 0, 1);
}

Plane product(const Plane& a, const Plane& b) {
  Plane result = a;
  for (std::size_t i = 0; i < a.values.size(); ++i) result.values[i] *= b.values[i];
  return result;
}

}  // namespace

double mean_ssim(const Image& a, const Image& b) {
  require_same_size(a, b);
  const Plane x = luma(a), y = luma(b);
  const Plane mean_x = blurred(x), mean_y = blurred(y);
  const Plane xx = blurred(product(x, x)), yy = blurred(product(y, y)), xy = blurred(product(x, y));
  double sum = 0.0;
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const double mx = mean_x.values[i], my = mean_y.values[i];
    const double vx = xx.values[i] - mx * mx, vy = yy.values[i] - my * my, cov = xy.values[i] - mx * my;
    sum += (2.0 * mx * my + kC1) * (2.0 * cov + kC2) / ((mx * mx + my * my + kC1) * (vx + vy + kC2));
  }
  return x.values.empty() ? 1.0 : sum / static_cast<double>(x.values.size());
}

}  // namespace vrc
