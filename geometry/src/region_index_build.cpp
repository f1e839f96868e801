// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "cell_range.h"
#include "core/error.h"
#include "geometry/region_index.h"

namespace vrc {
namespace {

constexpr std::uint32_t kMaxLog2Split = 5;

struct Bounds {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high = -low;
};

}  // namespace

// A footprint in units of the coarse cells of its patch; its ellipse is |shape (x - center)| <= 1.
struct RegionIndex::CellBox {
  std::uint32_t record = 0;
  Vec2 low = Vec2::Zero(), high = Vec2::Zero(), center = Vec2::Zero();
  Mat2 shape = Mat2::Zero();
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
    index_.list_begin_.push_back(entry_count());
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
      VRC_CHECK(f.center.allFinite() && f.shape.allFinite(), "record {} has no proper ellipse in patch {}",
                f.record, f.patch);
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
    for (const std::uint32_t i : members) boxes_.push_back(to_cells(footprints_[i], grid));
    list_by_cell(grid);
    const std::size_t cells = std::size_t{grid.width} * grid.height;
    for (std::size_t c = 0; c < cells; ++c) add_cell(grid, c);
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

  static CellBox to_cells(const PatchFootprint& f, const Grid& grid) {
    CellBox box;
    box.record = f.record;
    box.low = (f.low - grid.low) * grid.cells_per_unit;
    box.high = (f.high - grid.low) * grid.cells_per_unit;
    box.center = (f.center - grid.low) * grid.cells_per_unit;
    box.shape = triangular(f.shape / grid.cells_per_unit);
    return box;
  }

  // A lower triangular matrix that makes vectors as long as `shape` does, less the rounding to single
  // precision of its ellipse and of points in it.
  static Mat2 triangular(const Mat2& shape) {
    const double smallest = 1.0 / shape.norm();  // At most the smaller radius, in cells.
    if (!(smallest > 0.0) || !std::isfinite(smallest)) return Mat2::Zero();
    // Rows of the reflected matrix: shape = rotation * lower triangle.
    const double b1 = shape.col(1).norm();
    Mat2 lower = Mat2::Zero();
    lower(1, 1) = b1;
    lower(1, 0) = b1 > 0.0 ? shape.col(0).dot(shape.col(1)) / b1 : 0.0;
    const double determinant = std::abs(shape.determinant());
    lower(0, 0) = b1 > 0.0 ? determinant / b1 : shape.col(0).norm();
    if (!(determinant > 0.0)) return Mat2::Zero();
    const double largest = shape.norm() / determinant;  // At least the larger radius, in cells.
    constexpr double kRounding = 5e-7;
    return lower / (1.0 + kRounding * (2.0 + largest) / smallest);
  }

  template <typename Visit>
  static void for_each_cell(const Grid& grid, const CellBox& box, const Visit& visit) {
    const auto [i0, i1] = cell_range(box.low.x(), box.high.x(), grid.width);
    const auto [j0, j1] = cell_range(box.low.y(), box.high.y(), grid.height);
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

  // In units of the coarse cells, seen from the corner of one.
  static CellBox seen_from(const CellBox& box, const Vec2& corner) {
    CellBox seen = box;
    seen.low -= corner;
    seen.high -= corner;
    seen.center -= corner;
    return seen;
  }

  std::uint32_t choose_split() const {
    const double allowed = options_.entries_per_record * static_cast<double>(seen_.size());
    std::uint32_t log2_split = 0;
    while (!seen_.empty() && log2_split < kMaxLog2Split) {
      double entries = 0.0;
      for (const CellBox& box : seen_) entries += count_fine(box, 2u << log2_split);
      if (entries > allowed) break;
      ++log2_split;
    }
    return log2_split;
  }

  // Fine cells that the box and, about, the ellipse meet.
  static double count_fine(const CellBox& box, std::uint32_t split) {
    const auto [i0, i1] = cell_range(box.low.x() * split, box.high.x() * split, split);
    const auto [j0, j1] = cell_range(box.low.y() * split, box.high.y() * split, split);
    return (i1 - i0 + 1.0) * (j1 - j0 + 1.0);
  }

  template <typename Visit>
  static void for_each_fine(const CellBox& box, std::uint32_t split, const Visit& visit) {
    const auto [i0, i1] = cell_range(box.low.x() * split, box.high.x() * split, split);
    const auto [j0, j1] = cell_range(box.low.y() * split, box.high.y() * split, split);
    const double side = 1.0 / split;
    for (std::uint32_t j = j0; j <= j1; ++j) {
      for (std::uint32_t i = i0; i <= i1; ++i) {
        const Vec2 low(i * side, j * side);
        if (ellipse_meets(box, low, low + Vec2::Constant(side))) visit(std::size_t{j} * split + i);
      }
    }
  }

  static bool ellipse_meets(const CellBox& box, const Vec2& low, const Vec2& high) {
    const Vec2 from = low - box.center;
    const Vec2 to = high - box.center;
    if (from.maxCoeff() <= 0.0 && to.minCoeff() >= 0.0) return true;
    const std::array<Vec2, 4> p{box.shape * from, box.shape * Vec2(to.x(), from.y()), box.shape * to,
                                box.shape * Vec2(from.x(), to.y())};
    const Vec2 unit = Vec2::Ones();
    return meets_ellipse(p[0], p[1], unit) || meets_ellipse(p[1], p[2], unit) ||
           meets_ellipse(p[2], p[3], unit) || meets_ellipse(p[3], p[0], unit);
  }

  void add_cell(const Grid& grid, std::size_t c) {
    const Vec2 corner(static_cast<double>(c % grid.width), static_cast<double>(c / grid.width));
    seen_.clear();
    for (std::uint32_t b = cell_begin_[c]; b < cell_begin_[c + 1]; ++b) {
      seen_.push_back(seen_from(boxes_[cell_boxes_[b]], corner));
    }
    const std::uint32_t log2_split = choose_split();
    const std::uint32_t split = 1u << log2_split;
    index_.cells_.push_back({static_cast<std::uint32_t>(index_.list_begin_.size()), log2_split});
    if (lists_.size() < std::size_t{split} * split) lists_.resize(std::size_t{split} * split);
    for (const CellBox& box : seen_) {
      for_each_fine(box, split, [&](std::size_t f) { lists_[f].push_back(&box); });
    }
    for (std::size_t f = 0; f < std::size_t{split} * split; ++f) write(lists_[f]);
    VRC_CHECK(index_.list_begin_.size() < kInvalidIndex, "the index of {} footprints is too large",
              footprints_.size());
  }

  // Appends a list and empties it.
  void write(std::vector<const CellBox*>& list) {
    // Two boxes of one record, which follow each other, become one entry without an ellipse.
    std::size_t count = 0;
    static const CellBox kEverywhere;
    shapes_.clear();
    records_.clear();
    for (const CellBox* box : list) {
      if (count > 0 && records_.back() == box->record) {
        shapes_.back() = &kEverywhere;
        continue;
      }
      records_.push_back(box->record);
      shapes_.push_back(box);
      ++count;
    }
    list.clear();
    index_.list_begin_.push_back(entry_count());
    std::vector<std::uint32_t>& words = index_.words_;
    words.insert(words.end(), records_.begin(), records_.end());
    const auto put = [&](const auto& value) {
      for (const CellBox* box : shapes_)
        words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(value(*box))));
    };
    put([](const CellBox& box) { return box.center.x(); });
    put([](const CellBox& box) { return box.center.y(); });
    put([](const CellBox& box) { return box.shape(0, 0); });
    put([](const CellBox& box) { return box.shape(1, 0); });
    put([](const CellBox& box) { return box.shape(1, 1); });
  }

  std::uint32_t entry_count() const {
    VRC_CHECK(index_.entry_count() < kInvalidIndex, "the index of {} footprints is too large",
              footprints_.size());
    return static_cast<std::uint32_t>(index_.entry_count());
  }

  RegionIndex& index_;
  const std::span<const PatchFootprint> footprints_;
  const RegionIndexOptions& options_;
  std::vector<std::uint32_t> order_, patch_begin_;
  std::vector<CellBox> boxes_;  // Of one patch.
  std::vector<std::uint32_t> cell_begin_, cell_boxes_, cursor_;
  std::vector<CellBox> seen_;  // Of one coarse cell,
  std::vector<std::vector<const CellBox*>> lists_;
  std::vector<std::uint32_t> records_;  // and of one list.
  std::vector<const CellBox*> shapes_;
};

RegionIndex::RegionIndex(std::size_t patch_count, std::span<const PatchFootprint> footprints,
                         const RegionIndexOptions& options)
    : grids_(patch_count) {
  Builder(*this, footprints, options).build();
}

}  // namespace vrc
