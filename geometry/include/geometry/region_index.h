// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "geometry/patch_atlas.h"
#include "geometry/surface_walker.h"

namespace vrc {

/// Where a record may be used in one patch: where the box and the ellipse both hold (u, v).
struct PatchFootprint {
  std::uint32_t record = 0;
  std::uint32_t patch = 0;
  Vec2 low = Vec2::Zero();
  Vec2 high = Vec2::Zero();
  /// The ellipse is |shape (uv - center)| <= 1; a zero shape holds everywhere.
  Vec2 center = Vec2::Zero();
  /// Unaligned, so that std::stable_sort can take footprints: its buffer has the default alignment.
  Eigen::Matrix<double, 2, 2, Eigen::DontAlign> shape = Mat2::Zero();
};

/// Around the parts of a walked ellipse, one for each patch that it reaches, in rising order of the
/// patches: the smallest box, and the ellipse as the first face reached there maps it, grown to hold the
/// parts on the other faces. `radii` are those of the ellipse that was walked.
[[nodiscard]] std::vector<PatchFootprint> patch_footprints(const PatchAtlas& atlas, const SurfaceWalk& walk,
                                                           const Vec2& radii, std::uint32_t record);

/// The numbers 0 ... record_count - 1 in an order that keeps neighbours together: by the first patch of
/// each record and there along a Z-curve; records without footprints last. Records renumbered so take
/// few cache lines when points next to each other are looked up.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::size_t record_count,
                                                       std::span<const PatchFootprint> footprints);

struct RegionIndexOptions {
  double records_per_cell = 16.0;  ///< Records of a patch divided by the coarse cells of its grid.
  /// A coarse cell is split as long as a record then has at most so many entries in it, on average.
  double entries_per_record = 4.0;
};

/// A point of a patch.
struct PatchPoint {
  std::uint32_t patch = 0;
  Vec2 uv = Vec2::Zero();
};

/// Records of several points: those of point i are records[begin[i]] ... records[begin[i + 1] - 1].
struct RecordsOfPoints {
  std::vector<std::uint32_t> records;
  std::vector<std::uint32_t> begin;

  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t point) const {
    return std::span(records).subspan(begin[point], begin[point + 1] - begin[point]);
  }
};

/// Answers which records may cover a point of a patch.
///
/// Over every patch lies a coarse grid whose cells are split into 1, 2 x 2, ... 32 x 32 fine ones, as
/// the sizes of the records there ask. The list of a fine cell holds the numbers of its records and
/// then their ellipses in single precision, so a look-up reads one run of memory. All answers are in
/// rising order, hold whatever the exact answer holds, and may hold some more. Immutable; read from
/// any number of threads.
class RegionIndex {
 public:
  /// The footprints may be in any order; the index does not depend on it.
  RegionIndex(std::size_t patch_count, std::span<const PatchFootprint> footprints,
              const RegionIndexOptions& options = {});

  /// Records with a footprint near (u, v): of its fine cell.
  [[nodiscard]] std::span<const std::uint32_t> candidates(std::uint32_t patch, const Vec2& uv) const {
    const List list = list_at({patch, uv});
    return {list.words, list.count};
  }

  /// Appends the candidates whose ellipse holds (u, v), up to single precision.
  void covering(const PatchPoint& point, std::vector<std::uint32_t>& result) const;

  /// The same for many points. Memory is asked for ahead, so that points far from each other do not
  /// wait one by one; 16 at a time suffice.
  void covering(std::span<const PatchPoint> points, RecordsOfPoints& result) const;

  /// Appends the records with a footprint near the closed box [low, high] of (u, v), once each. One
  /// call answers for all points of a tile.
  void find(std::uint32_t patch, const Vec2& low, const Vec2& high, std::vector<std::uint32_t>& result) const;

  /// Records in the lists, counted in each.
  [[nodiscard]] std::size_t entry_count() const { return words_.size() / kEntryWords; }
  /// Of the arrays. [bytes]
  [[nodiscard]] std::size_t memory() const;

 private:
  /// Of an entry: the record, the ellipse's centre (2) and its lower triangular shape (3). A list
  /// holds first all records, then all x of the centres, and so on.
  static constexpr std::size_t kEntryWords = 6;

  struct Grid {
    Vec2 low = Vec2::Zero();
    double cells_per_unit = 0.0;
    std::uint32_t width = 0, height = 0;
    std::size_t first_cell = 0;
  };
  struct Cell {
    std::uint32_t first_list = 0;  ///< Of its fine cells, row by row.
    std::uint32_t log2_split = 0;
  };
  /// Where a point lies: in `cell`, at (x, y) of its unit square.
  struct CellPoint {
    const Cell* cell = nullptr;  ///< None outside.
    double x = 0.0, y = 0.0;
  };
  struct List {
    const std::uint32_t* words = nullptr;
    std::size_t count = 0;
  };
  struct CellBox;
  class Builder;

  [[nodiscard]] CellPoint locate(const PatchPoint& point) const {
    const Grid& grid = grids_[point.patch];
    const double x = (point.uv.x() - grid.low.x()) * grid.cells_per_unit;
    const double y = (point.uv.y() - grid.low.y()) * grid.cells_per_unit;
    // Written so that NaN is outside.
    if (!(x >= 0.0 && y >= 0.0 && x < grid.width && y < grid.height)) return {};
    const auto i = static_cast<std::uint32_t>(x);
    const auto j = static_cast<std::uint32_t>(y);
    const Cell* cell = &cells_[grid.first_cell + std::size_t{j} * grid.width + i];
    return {cell, x - i, y - j};
  }
  [[nodiscard]] static std::size_t list_of(const CellPoint& at) {
    const std::uint32_t split = 1u << at.cell->log2_split;
    const auto i = static_cast<std::uint32_t>(at.x * split);
    const auto j = static_cast<std::uint32_t>(at.y * split);
    return at.cell->first_list + ((std::size_t{j} << at.cell->log2_split) + i);
  }
  [[nodiscard]] List list(std::size_t number) const {
    const std::uint32_t begin = list_begin_[number];
    return {words_.data() + kEntryWords * begin, list_begin_[number + 1] - begin};
  }
  [[nodiscard]] List list_at(const PatchPoint& point) const {
    const CellPoint at = locate(point);
    return at.cell == nullptr ? List{} : list(list_of(at));
  }
  static std::size_t select(const List& list, const CellPoint& at, std::uint32_t* selected);

  std::vector<Grid> grids_;  ///< Per patch.
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> list_begin_;  ///< Per fine cell of all coarse ones, and the end. [entries]
  std::vector<std::uint32_t> words_;
};

}  // namespace vrc
