// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_painter.h"

#include <algorithm>
#include <cmath>

namespace vrc {
namespace {

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

/// The pixels [first, second) of a row or column whose centres lie between two coordinates.
std::pair<int, int> pixels_between(double low, double high, int count) {
  const double limit = count;
  return {static_cast<int>(std::clamp(std::floor(low), 0.0, limit)),
          static_cast<int>(std::clamp(std::ceil(high), 0.0, limit))};
}

}  // namespace

LinePainter::LinePainter(int width, int height)
    : width_(width),
      height_(height),
      coverage_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f) {}

void LinePainter::stroke(const Vec2& a, const Vec2& b, double radius) {
  const double reach = radius + 0.5;  // The edge fades over one pixel.
  const auto [x0, x1] =
      pixels_between(std::min(a.x(), b.x()) - reach, std::max(a.x(), b.x()) + reach, width_);
  const auto [y0, y1] =
      pixels_between(std::min(a.y(), b.y()) - reach, std::max(a.y(), b.y()) + reach, height_);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const double inside = reach - distance_to_segment(Vec2(x + 0.5, y + 0.5), a, b);
      // A stroke thinner than a pixel covers at most its width.
      const auto value = static_cast<float>(std::clamp(inside, 0.0, std::min(1.0, 2.0 * radius)));
      float& slot = coverage_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                              static_cast<std::size_t>(x)];
      slot = std::max(slot, value);
    }
  }
}

}  // namespace vrc
