// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/chart_points.h"

#include <algorithm>
#include <cmath>

namespace vrc {
namespace {

constexpr double kPointsPerCell = 4.0;

}  // namespace

ChartPoints::ChartPoints(std::size_t patch_count, std::span<const ChartPoint> points)
    : grids_(patch_count), indices_(points.size()) {
  struct Extent {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
    Vec2 high = -low;
    std::size_t count = 0;
  };
  std::vector<Extent> extents(patch_count);
  for (const ChartPoint& p : points) {
    Extent& e = extents[p.patch];
    e.low = e.low.cwiseMin(p.uv);
    e.high = e.high.cwiseMax(p.uv);
    ++e.count;
  }
  std::size_t cells = 0;
  for (std::size_t p = 0; p < patch_count; ++p) {
    const Extent& e = extents[p];
    if (e.count == 0) continue;
    const Vec2 size = e.high - e.low;
    const double wanted = std::max(1.0, static_cast<double>(e.count) / kPointsPerCell);
    // One row of cells where the points lie on a line; the side is never 0.
    const double side = std::max({std::sqrt(size.x() * size.y() / wanted), size.maxCoeff() / wanted, 1e-290});
    Grid& grid = grids_[p];
    grid.low = e.low;
    grid.cells_per_unit = 1.0 / side;
    grid.width = static_cast<std::uint32_t>(size.x() * grid.cells_per_unit) + 1;
    grid.height = static_cast<std::uint32_t>(size.y() * grid.cells_per_unit) + 1;
    grid.first_cell = cells;
    cells += std::size_t{grid.width} * grid.height;
  }
  cell_begin_.assign(cells + 1, 0);
  for (const ChartPoint& p : points) ++cell_begin_[cell_of(p) + 1];
  for (std::size_t c = 0; c < cells; ++c) cell_begin_[c + 1] += cell_begin_[c];
  std::vector<std::uint32_t> cursor(cell_begin_.begin(), cell_begin_.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i) indices_[cursor[cell_of(points[i])]++] = i;
}

std::size_t ChartPoints::cell_of(const ChartPoint& point) const {
  const Grid& grid = grids_[point.patch];
  const Vec2 cell = (point.uv - grid.low) * grid.cells_per_unit;
  return grid.first_cell + static_cast<std::size_t>(cell.y()) * grid.width +
         static_cast<std::size_t>(cell.x());
}

}  // namespace vrc
