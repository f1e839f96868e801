// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/types.h"

namespace vrc {

/// Draws strokes with smooth edges into a layer of coverages: the largest that any stroke gives a
/// pixel, so that strokes may overlap and come in any order.
class LinePainter {
 public:
  LinePainter(int width, int height);

  /// Points at most `radius` from the segment between two film positions; a dot where they coincide.
  void stroke(const Vec2& a, const Vec2& b, double radius);
  /// In [0, 1].
  [[nodiscard]] float coverage(int x, int y) const {
    return coverage_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                     static_cast<std::size_t>(x)];
  }

 private:
  int width_, height_;
  std::vector<float> coverage_;
};

}  // namespace vrc
