// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "placement/surface_reach.h"

namespace vrc {

/// A point of a chart.
struct ChartPoint {
  std::uint32_t patch = 0;
  Vec2 uv = Vec2::Zero();
};

/// Points in the charts of a scene, in a uniform grid over each patch. Immutable.
class ChartPoints {
 public:
  ChartPoints(std::size_t patch_count, std::span<const ChartPoint> points);

  /// Calls body(index) for all points in the box and some near it, in an order that depends on the
  /// points only.
  template <typename Body>
  void for_each_near(const PatchBox& box, const Body& body) const {
    const Grid& grid = grids_[box.patch];
    if (grid.width == 0) return;
    const auto [i0, i1] = range(box.low.x() - grid.low.x(), box.high.x() - grid.low.x(), grid, grid.width);
    const auto [j0, j1] = range(box.low.y() - grid.low.y(), box.high.y() - grid.low.y(), grid, grid.height);
    for (std::int64_t j = j0; j <= j1; ++j) {
      const std::size_t row = grid.first_cell + static_cast<std::size_t>(j) * grid.width;
      for (std::int64_t i = i0; i <= i1; ++i) {
        const std::size_t cell = row + static_cast<std::size_t>(i);
        for (std::uint32_t k = cell_begin_[cell]; k < cell_begin_[cell + 1]; ++k) body(indices_[k]);
      }
    }
  }

 private:
  struct Grid {
    Vec2 low = Vec2::Zero();
    double cells_per_unit = 0.0;
    std::uint32_t width = 0, height = 0;
    std::size_t first_cell = 0;
  };
  /// First and last cell that an interval meets; an empty range (0, -1) when it meets none.
  static std::pair<std::int64_t, std::int64_t> range(double low, double high, const Grid& grid,
                                                     std::uint32_t count) {
    const double a = low * grid.cells_per_unit, b = high * grid.cells_per_unit;
    if (!(b >= 0.0 && a < count)) return {0, -1};
    return {static_cast<std::int64_t>(std::max(a, 0.0)), static_cast<std::int64_t>(std::min(b, count - 1.0))};
  }
  [[nodiscard]] std::size_t cell_of(const ChartPoint& point) const;

  std::vector<Grid> grids_;                ///< Per patch.
  std::vector<std::uint32_t> cell_begin_;  ///< Per cell, and the end.
  std::vector<std::uint32_t> indices_;
};

}  // namespace vrc
