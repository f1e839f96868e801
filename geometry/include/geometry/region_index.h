// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "geometry/patch_atlas.h"
#include "geometry/surface_walker.h"

namespace vrc {

/// Where a record may be used in one patch: a box in its (u, v).
struct PatchFootprint {
  std::uint32_t record = 0;
  std::uint32_t patch = 0;
  Vec2 low = Vec2::Zero();
  Vec2 high = Vec2::Zero();
};

/// The smallest boxes in (u, v) around the parts of a walked ellipse, one for each patch that it
/// reaches, in rising order of the patches. `radii` are those of the ellipse that was walked.
[[nodiscard]] std::vector<PatchFootprint> patch_footprints(const PatchAtlas& atlas, const SurfaceWalk& walk,
                                                           const Vec2& radii, std::uint32_t record);

/// The numbers 0 ... record_count - 1 in an order that keeps neighbours together: by the first patch of
/// each record and there along a Z-curve; records without footprints last. Records renumbered so take
/// few cache lines when points next to each other are looked up.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::size_t record_count,
                                                       std::span<const PatchFootprint> footprints);

struct RegionIndexOptions {
  double records_per_cell = 4.0;  ///< Records of a patch divided by the coarse cells of its grid.
  /// A coarse cell is split as long as a record then has at most so many entries in it, on average.
  double entries_per_record = 4.0;
};

/// Answers which records may cover a point of a patch.
///
/// Over every patch lies a coarse grid whose cells are split into 1, 2 x 2, ... 32 x 32 fine ones, as
/// the sizes of the records there ask. Immutable; read from any number of threads.
class RegionIndex {
 public:
  /// The footprints may be in any order; the index does not depend on it.
  RegionIndex(std::size_t patch_count, std::span<const PatchFootprint> footprints,
              const RegionIndexOptions& options = {});

  /// Records with a footprint near (u, v), in rising order: all whose box holds it, and some more.
  [[nodiscard]] std::span<const std::uint32_t> candidates(std::uint32_t patch, const Vec2& uv) const {
    const Grid& grid = grids_[patch];
    const double x = (uv.x() - grid.low.x()) * grid.cells_per_unit;
    const double y = (uv.y() - grid.low.y()) * grid.cells_per_unit;
    // Written so that NaN is outside.
    if (!(x >= 0.0 && y >= 0.0 && x < grid.width && y < grid.height)) return {};
    const auto i = static_cast<std::uint32_t>(x);
    const auto j = static_cast<std::uint32_t>(y);
    const Cell& cell = cells_[grid.first_cell + std::size_t{j} * grid.width + i];
    const std::uint32_t split = 1u << cell.log2_split;
    const auto fine_i = static_cast<std::uint32_t>((x - i) * split);
    const auto fine_j = static_cast<std::uint32_t>((y - j) * split);
    const std::size_t fine = cell.first_list + ((std::size_t{fine_j} << cell.log2_split) + fine_i);
    return {entries_.data() + list_begin_[fine], entries_.data() + list_begin_[fine + 1]};
  }

  /// Appends the records with a footprint near the closed box [low, high] of (u, v), once each and in
  /// rising order: all whose box meets it, and some more. One call answers for all points of a tile.
  void find(std::uint32_t patch, const Vec2& low, const Vec2& high, std::vector<std::uint32_t>& result) const;

  [[nodiscard]] std::size_t entry_count() const { return entries_.size(); }
  /// Of the arrays. [bytes]
  [[nodiscard]] std::size_t memory() const;

 private:
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
  struct CellBox;
  class Builder;

  std::vector<Grid> grids_;  ///< Per patch.
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> list_begin_;  ///< Per fine cell of all coarse ones, and the end.
  std::vector<std::uint32_t> entries_;     ///< Records.
};

}  // namespace vrc
