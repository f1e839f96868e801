// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/region_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/error.h"

namespace vrc {
namespace {

constexpr std::uint32_t kMaxLog2Split = 5;

struct Bounds {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high = -low;
};

// First and last of `count` unit cells that the interval meets; it does meet some.
std::pair<std::uint32_t, std::uint32_t> range(double low, double high, std::uint32_t count) {
  const double last = count - 1.0;
  return {static_cast<std::uint32_t>(std::clamp(std::floor(low), 0.0, last)),
          static_cast<std::uint32_t>(std::clamp(std::floor(high), 0.0, last))};
}

}  // namespace

// A footprint in units of the coarse cells of its patch.
struct RegionIndex::CellBox {
  Vec2 low, high;
};

// The footprints are visited patch by patch, cell by cell. All positions go through the same
// arithmetic as those of queries, which is monotonic, so a point inside a box is in one of its cells.
class RegionIndex::Builder {
 public:
  Builder(RegionIndex& index, std::span<const PatchFootprint> footprints, const RegionIndexOptions& options)
      : index_(index), footprints_(footprints), options_(options) {}

  void build() {
    sort_by_patch();
    for (std::size_t p = 0; p < index_.grids_.size(); ++p) add_patch(p);
    index_.list_begin_.push_back(static_cast<std::uint32_t>(index_.entries_.size()));
  }

 private:
  // By patch, record and box, so that the order of the input does not matter.
  void sort_by_patch() {
    order_.resize(footprints_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    const auto key = [this](std::uint32_t i) {
      const PatchFootprint& f = footprints_[i];
      return std::tuple(f.patch, f.record, f.low.x(), f.low.y(), f.high.x(), f.high.y());
    };
    std::sort(order_.begin(), order_.end(),
              [&key](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    patch_begin_.assign(index_.grids_.size() + 1, 0);
    for (const PatchFootprint& f : footprints_) {
      VRC_CHECK(f.patch < index_.grids_.size(), "patch {} of {}", f.patch, index_.grids_.size());
      VRC_CHECK(f.low.allFinite() && f.high.allFinite() && (f.low.array() <= f.high.array()).all(),
                "record {} has no proper box in patch {}", f.record, f.patch);
      ++patch_begin_[f.patch + 1];
    }
    for (std::size_t p = 0; p < index_.grids_.size(); ++p) patch_begin_[p + 1] += patch_begin_[p];
  }

  std::span<const std::uint32_t> footprints_of(std::size_t patch) const {
    return std::span(order_).subspan(patch_begin_[patch], patch_begin_[patch + 1] - patch_begin_[patch]);
  }

  void add_patch(std::size_t patch) {
    const std::span<const std::uint32_t> members = footprints_of(patch);
    if (members.empty()) return;
    place_grid(index_.grids_[patch], members);
    const Grid& grid = index_.grids_[patch];
    boxes_.clear();
    for (const std::uint32_t i : members) {
      boxes_.push_back({(footprints_[i].low - grid.low) * grid.cells_per_unit,
                        (footprints_[i].high - grid.low) * grid.cells_per_unit});
    }
    list_by_cell(grid);
    const std::size_t cells = std::size_t{grid.width} * grid.height;
    for (std::size_t c = 0; c < cells; ++c) add_cell(grid, members, c);
  }

  // So many cells that each holds `records_per_cell` centres on average.
  void place_grid(Grid& grid, std::span<const std::uint32_t> members) {
    Bounds bounds;
    for (const std::uint32_t i : members) {
      bounds.low = bounds.low.cwiseMin(footprints_[i].low);
      bounds.high = bounds.high.cwiseMax(footprints_[i].high);
    }
    const Vec2 size = bounds.high - bounds.low;
    const double wanted =
        std::max(1.0, static_cast<double>(members.size()) / std::max(1e-3, options_.records_per_cell));
    // A thin patch has one row of cells. The side is never 0, also for a single point.
    double side = std::max(std::sqrt(size.x() * size.y() / wanted), size.maxCoeff() / wanted);
    side = std::max(side, std::numeric_limits<double>::min() * 1e16);
    grid.low = bounds.low;
    grid.cells_per_unit = 1.0 / side;
    grid.width = static_cast<std::uint32_t>(size.x() * grid.cells_per_unit) + 1;
    grid.height = static_cast<std::uint32_t>(size.y() * grid.cells_per_unit) + 1;
    grid.first_cell = index_.cells_.size();
  }

  template <typename Visit>
  static void for_each_cell(const Grid& grid, const CellBox& box, const Visit& visit) {
    const auto [i0, i1] = range(box.low.x(), box.high.x(), grid.width);
    const auto [j0, j1] = range(box.low.y(), box.high.y(), grid.height);
    for (std::uint32_t j = j0; j <= j1; ++j) {
      for (std::uint32_t i = i0; i <= i1; ++i) visit(std::size_t{j} * grid.width + i);
    }
  }

  // Per coarse cell the boxes that meet it, in rising order.
  void list_by_cell(const Grid& grid) {
    cell_begin_.assign(std::size_t{grid.width} * grid.height + 1, 0);
    for (const CellBox& box : boxes_) for_each_cell(grid, box, [&](std::size_t c) { ++cell_begin_[c + 1]; });
    for (std::size_t c = 1; c < cell_begin_.size(); ++c) cell_begin_[c] += cell_begin_[c - 1];
    cell_boxes_.resize(cell_begin_.back());
    cursor_.assign(cell_begin_.begin(), cell_begin_.end() - 1);
    for (std::uint32_t b = 0; b < boxes_.size(); ++b) {
      for_each_cell(grid, boxes_[b], [&](std::size_t c) { cell_boxes_[cursor_[c]++] = b; });
    }
  }

  // The box inside a coarse cell, in units of its fine cells.
  CellBox fine_box(const CellBox& box, double i, double j, double split) const {
    const Vec2 corner(i, j);
    return {(box.low - corner) * split, (box.high - corner) * split};
  }

  std::uint32_t choose_split(std::span<const std::uint32_t> list, double i, double j) const {
    const double allowed = options_.entries_per_record * static_cast<double>(list.size());
    std::uint32_t log2_split = 0;
    while (!list.empty() && log2_split < kMaxLog2Split) {
      const std::uint32_t split = 2u << log2_split;
      double entries = 0.0;
      for (const std::uint32_t b : list) {
        const CellBox box = fine_box(boxes_[b], i, j, split);
        const auto [i0, i1] = range(box.low.x(), box.high.x(), split);
        const auto [j0, j1] = range(box.low.y(), box.high.y(), split);
        entries += (i1 - i0 + 1.0) * (j1 - j0 + 1.0);
      }
      if (entries > allowed) break;
      ++log2_split;
    }
    return log2_split;
  }

  void add_cell(const Grid& grid, std::span<const std::uint32_t> members, std::size_t c) {
    const auto list = std::span<const std::uint32_t>(cell_boxes_)
                          .subspan(cell_begin_[c], cell_begin_[c + 1] - cell_begin_[c]);
    const auto i = static_cast<double>(c % grid.width);
    const auto j = static_cast<double>(c / grid.width);
    const std::uint32_t log2_split = choose_split(list, i, j);
    const Grid fine{Vec2::Zero(), 1.0, 1u << log2_split, 1u << log2_split, 0};
    const auto first_list = static_cast<std::uint32_t>(index_.list_begin_.size());
    index_.cells_.push_back({first_list, log2_split});
    lists_.assign(std::size_t{fine.width} * fine.height, {});
    for (const std::uint32_t b : list) {
      const std::uint32_t record = footprints_[members[b]].record;
      for_each_cell(fine, fine_box(boxes_[b], i, j, fine.width), [&](std::size_t f) {
        // Two boxes of one record follow each other.
        if (lists_[f].empty() || lists_[f].back() != record) lists_[f].push_back(record);
      });
    }
    for (const std::vector<std::uint32_t>& records : lists_) {
      index_.list_begin_.push_back(static_cast<std::uint32_t>(index_.entries_.size()));
      index_.entries_.insert(index_.entries_.end(), records.begin(), records.end());
    }
    VRC_CHECK(index_.entries_.size() < kInvalidIndex && index_.list_begin_.size() < kInvalidIndex,
              "the index of {} footprints is too large", footprints_.size());
  }

  RegionIndex& index_;
  const std::span<const PatchFootprint> footprints_;
  const RegionIndexOptions& options_;
  std::vector<std::uint32_t> order_, patch_begin_;
  std::vector<CellBox> boxes_;  // Of one patch.
  std::vector<std::uint32_t> cell_begin_, cell_boxes_, cursor_;
  std::vector<std::vector<std::uint32_t>> lists_;  // Of one coarse cell.
};

RegionIndex::RegionIndex(std::size_t patch_count, std::span<const PatchFootprint> footprints,
                         const RegionIndexOptions& options)
    : grids_(patch_count) {
  Builder(*this, footprints, options).build();
}

void RegionIndex::find(std::uint32_t patch, const Vec2& low, const Vec2& high,
                       std::vector<std::uint32_t>& result) const {
  const Grid& grid = grids_[patch];
  const Vec2 from = (low - grid.low) * grid.cells_per_unit;
  const Vec2 to = (high - grid.low) * grid.cells_per_unit;
  // Written so that NaN is outside, as is every box of a patch without cells.
  if (!(from.x() <= to.x() && from.y() <= to.y() && to.x() >= 0.0 && to.y() >= 0.0 && from.x() < grid.width &&
        from.y() < grid.height)) {
    return;
  }
  const auto known = static_cast<std::ptrdiff_t>(result.size());
  const auto [i0, i1] = range(from.x(), to.x(), grid.width);
  const auto [j0, j1] = range(from.y(), to.y(), grid.height);
  for (std::uint32_t j = j0; j <= j1; ++j) {
    for (std::uint32_t i = i0; i <= i1; ++i) {
      const Cell& cell = cells_[grid.first_cell + std::size_t{j} * grid.width + i];
      const std::uint32_t split = 1u << cell.log2_split;
      const auto [k0, k1] = range((from.x() - i) * split, (to.x() - i) * split, split);
      const auto [l0, l1] = range((from.y() - j) * split, (to.y() - j) * split, split);
      for (std::uint32_t l = l0; l <= l1; ++l) {
        // The lists of a row of fine cells follow each other.
        const std::size_t row = cell.first_list + (std::size_t{l} << cell.log2_split);
        result.insert(result.end(), entries_.begin() + list_begin_[row + k0],
                      entries_.begin() + list_begin_[row + k1 + 1]);
      }
    }
  }
  std::sort(result.begin() + known, result.end());
  result.erase(std::unique(result.begin() + known, result.end()), result.end());
}

std::size_t RegionIndex::memory() const {
  return grids_.size() * sizeof(Grid) + cells_.size() * sizeof(Cell) +
         (list_begin_.size() + entries_.size()) * sizeof(std::uint32_t);
}

}  // namespace vrc
