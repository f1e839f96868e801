// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/simd.h"
#include "placement/gather.h"

namespace vrc {

/// Over the unit square (u1, u2) from which a gather's directions are sampled: the mean square in each cell
/// of the luminance that arrives, or of what it contributes to the gather.
struct GuideHistogram {
  static constexpr int kColumns = 64;  ///< Of u1, which also chooses the strategy: eight to an eighth.
  static constexpr int kRows = 32;     ///< Of u2, an azimuth.
  static constexpr int kCells = kColumns * kRows;

  std::array<float, kCells> mean_square{};  ///< Entry column * kRows + row.
};

/// A histogram as it is kept with each of many records, in half the space: rounded to eight significant bits.
class KeptHistogram {
 public:
  explicit KeptHistogram(const GuideHistogram& histogram);

  /// Adds `weight` times the mean squares of the cells from `first` on.
  void add_to(std::span<float> cells, std::size_t first, float weight) const;

 private:
  std::array<std::uint16_t, GuideHistogram::kCells> upper_bits_;  ///< Of single-precision numbers.
};

/// Moves uniform points of the unit square to where a histogram found large contributions: piecewise
/// constant density 0.15 + 0.85 t / mean(t), t the root mean square. Any histogram of other rays leaves the
/// estimate unbiased, however wrong it is.
class GuideWarp {
 public:
  /// By the mean squares of contributions. Columns [first[i], first[i + 1]) belong to one sampling strategy;
  /// the histogram is smoothed over neighbouring cells of the same strategy, the azimuth wrapping round.
  GuideWarp(const GuideHistogram& histogram, const std::vector<int>& first_columns);

  struct Point16 {
    F16 u1, u2;
    F16 density;  ///< Of the warp, 1 on average.
  };
  [[nodiscard]] Point16 operator()(F16 v1, F16 v2) const;

  /// Density of cell column * kRows + row.
  [[nodiscard]] float density(int cell) const { return density_[static_cast<std::size_t>(cell)]; }

 private:
  static constexpr int kColumns = GuideHistogram::kColumns, kRows = GuideHistogram::kRows;
  std::array<float, kColumns> column_start_{};  ///< Cumulative share of the columns before.
  std::array<float, kColumns> column_share_{};
  std::array<float, GuideHistogram::kCells> row_start_{};  ///< Within the column.
  std::array<float, GuideHistogram::kCells> density_{};
};

/// Cells of sixteen points of the unit square.
[[nodiscard]] I16 guide_cells(F16 u1, F16 u2);

/// Radiance that gathers found, found again by where the camera sees them.
class GuideField {
 public:
  explicit GuideField(const Scene& scene);

  /// `found`: mean squares of arriving luminance, as `Guidance::found`.
  void add(const RecordSite& site, std::shared_ptr<const KeptHistogram> found);

  /// The warp by what the (up to eight) nearest gathers within 24 pixels found, whatever their materials
  /// and normals: weighted by distance and by how densely each looked in a direction, times what the site's
  /// BRDF makes of that direction, or on average the BRDF of points that are seen like `views`, whose
  /// incident directions do not matter. `own`, unless null, are other rays from the site. Null when there is
  /// nothing.
  [[nodiscard]] std::unique_ptr<const GuideWarp> warp_at(const RecordSite& site,
                                                         const KeptHistogram* own = nullptr,
                                                         std::span<const Directions16> views = {}) const;

 private:
  struct Entry {
    Vec3 position, normal, to_camera;
    std::int32_t material;
    std::shared_ptr<const KeptHistogram> found;
  };
  struct Near {
    double squared_distance;  ///< In pixels of the site.
    std::uint32_t entry;
  };
  [[nodiscard]] std::vector<Near> nearest(const RecordSite& site) const;
  [[nodiscard]] Eigen::Vector2i cell_of(const Vec3& position) const;

  const Scene& scene_;
  int columns_ = 0, rows_ = 0;
  std::vector<Entry> entries_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace vrc
