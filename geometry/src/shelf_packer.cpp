// SPDX-License-Identifier: GPL-3.0-or-later
#include "shelf_packer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vrc {

PackedLayout pack_shelves(std::span<const Vec2> sizes) {
  PackedLayout layout;
  layout.offset.resize(sizes.size(), Vec2::Zero());
  if (sizes.empty()) return layout;
  double area = 0.0;
  double widest = 0.0;
  for (const Vec2& s : sizes) {
    area += s.x() * s.y();
    widest = std::max(widest, s.x());
  }
  constexpr double kGapShare = 0.02;  // Of a mean rectangle's side.
  const double gap = kGapShare * std::sqrt(area / static_cast<double>(sizes.size()));
  double padded_area = 0.0;
  for (const Vec2& s : sizes) padded_area += (s.x() + gap) * (s.y() + gap);
  const double width = std::max(widest, std::sqrt(padded_area)) + 2.0 * gap;

  std::vector<std::uint32_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return sizes[a].y() > sizes[b].y(); });
  Vec2 pen(gap, gap);
  double shelf_height = 0.0;
  for (const std::uint32_t i : order) {
    if (pen.x() > gap && pen.x() + sizes[i].x() + gap > width) {
      pen = Vec2(gap, pen.y() + shelf_height + gap);
      shelf_height = 0.0;
    }
    layout.offset[i] = pen;
    layout.size = layout.size.cwiseMax(pen + sizes[i] + Vec2::Constant(gap));
    shelf_height = std::max(shelf_height, sizes[i].y());
    pen.x() += sizes[i].x() + gap;
  }
  return layout;
}

}  // namespace vrc
