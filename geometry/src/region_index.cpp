// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/region_index.h"

#include <algorithm>
#include <array>
#include <bit>

#include "cell_range.h"

namespace vrc {
namespace {

// Asks for memory that will be read soon; no meaning beyond speed.
inline void prefetch(const void* address) { __builtin_prefetch(address); }

constexpr std::size_t kLine = 64;  // [bytes]

}  // namespace

// Writes the records whose ellipse holds the point and returns how many; `selected` has room for all.
std::size_t RegionIndex::select(const List& list, const CellPoint& at, std::uint32_t* selected) {
  constexpr std::size_t kBlock = 16;
  std::array<float, kBlock> distance;  // Squared.
  const auto x = static_cast<float>(at.x);
  const auto y = static_cast<float>(at.y);
  const std::size_t n = list.count;
  const std::uint32_t* words = list.words + n;
  std::size_t count = 0;
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t size = std::min(kBlock, n - begin);
    for (std::size_t i = 0; i < size; ++i) {
      const auto word = [&](std::size_t field) { return std::bit_cast<float>(words[field * n + begin + i]); };
      const float dx = x - word(0);
      const float dy = y - word(1);
      const float a = word(2) * dx;
      const float b = word(3) * dx + word(4) * dy;
      distance[i] = a * a + b * b;
    }
    for (std::size_t i = 0; i < size; ++i) {
      selected[count] = list.words[begin + i];
      count += distance[i] <= 1.0f ? 1 : 0;
    }
  }
  return count;
}

void RegionIndex::covering(const PatchPoint& point, std::vector<std::uint32_t>& result) const {
  const CellPoint at = locate(point);
  if (at.cell == nullptr) return;
  const List found = list(list_of(at));
  const std::size_t known = result.size();
  result.resize(known + found.count + 1);
  result.resize(known + select(found, at, result.data() + known));
}

// Three rounds, each of which asks for the memory that the next one reads: of the coarse cells, of the
// places of the lists, and of the lists.
void RegionIndex::covering(std::span<const PatchPoint> points, RecordsOfPoints& result) const {
  constexpr std::size_t kBatch = 16;
  result.begin.assign(1, 0);
  std::size_t known = 0;
  for (std::size_t first = 0; first < points.size(); first += kBatch) {
    const std::size_t size = std::min(kBatch, points.size() - first);
    std::array<CellPoint, kBatch> at;
    std::array<std::size_t, kBatch> numbers;
    std::array<List, kBatch> lists;
    for (std::size_t i = 0; i < size; ++i) {
      at[i] = locate(points[first + i]);
      prefetch(at[i].cell);
    }
    for (std::size_t i = 0; i < size; ++i) {
      if (at[i].cell == nullptr) continue;
      numbers[i] = list_of(at[i]);
      prefetch(&list_begin_[numbers[i]]);
    }
    std::size_t total = 1;
    for (std::size_t i = 0; i < size; ++i) {
      lists[i] = at[i].cell == nullptr ? List{} : list(numbers[i]);
      total += lists[i].count;
      const char* bytes = reinterpret_cast<const char*>(lists[i].words);
      for (std::size_t b = 0; b < 4 * kEntryWords * lists[i].count; b += kLine) prefetch(bytes + b);
    }
    if (result.records.size() < known + total) result.records.resize(2 * (known + total));
    for (std::size_t i = 0; i < size; ++i) {
      known += select(lists[i], at[i], result.records.data() + known);
      result.begin.push_back(static_cast<std::uint32_t>(known));
    }
  }
  result.records.resize(known);
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
  const auto [i0, i1] = cell_range(from.x(), to.x(), grid.width);
  const auto [j0, j1] = cell_range(from.y(), to.y(), grid.height);
  for (std::uint32_t j = j0; j <= j1; ++j) {
    for (std::uint32_t i = i0; i <= i1; ++i) {
      const Cell& cell = cells_[grid.first_cell + std::size_t{j} * grid.width + i];
      const std::uint32_t split = 1u << cell.log2_split;
      const auto [k0, k1] = cell_range((from.x() - i) * split, (to.x() - i) * split, split);
      const auto [l0, l1] = cell_range((from.y() - j) * split, (to.y() - j) * split, split);
      for (std::uint32_t l = l0; l <= l1; ++l) {
        for (std::uint32_t k = k0; k <= k1; ++k) {
          const List found = list(cell.first_list + ((std::size_t{l} << cell.log2_split) + k));
          result.insert(result.end(), found.words, found.words + found.count);
        }
      }
    }
  }
  std::sort(result.begin() + known, result.end());
  result.erase(std::unique(result.begin() + known, result.end()), result.end());
}

std::size_t RegionIndex::memory() const {
  return grids_.size() * sizeof(Grid) + cells_.size() * sizeof(Cell) +
         (list_begin_.size() + words_.size()) * sizeof(std::uint32_t);
}

}  // namespace vrc
