// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "placement/place_records.h"
#include "placement/record.h"

namespace vrc {

/// The surfaces seen through the pixel centres, and which of them the records cover.
class PixelGrid {
 public:
  PixelGrid(const Scene& scene, const PlacementView& view, std::uint64_t& camera_rays);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::size_t size() const { return points_.size(); }

  /// Pixels that need a record but are not covered.
  [[nodiscard]] bool is_open(std::size_t pixel) const { return points_[pixel].scatters && !covered_[pixel]; }
  [[nodiscard]] std::optional<SurfacePoint> surface_point(const Scene& scene, std::size_t pixel) const;
  /// Key for the random numbers of a record at this pixel: depends on film coordinates only.
  [[nodiscard]] std::uint64_t key(std::size_t pixel) const;

  /// Marks the pixels inside the record's region (joint distance below 1, same smooth region).
  void cover(const ValidRegion& region, std::int32_t smooth_region);
  void clear_coverage();

  /// All pixels, coarse to fine: every prefix of 4^k pixels is spread evenly.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }
  /// Length of the prefix of `order` that is a lattice of the given stride (a power of two).
  [[nodiscard]] std::size_t lattice_prefix(int stride) const;

 private:
  struct Point {
    Vec3f position, normal;
    std::int32_t region = -1;
    std::uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
    bool scatters = false;
  };
  struct PixelRect {
    int x0, y0, x1, y1;
  };
  [[nodiscard]] PixelRect footprint(const ValidRegion& region) const;

  const Camera camera_;
  int x0_, y0_, width_, height_;
  std::vector<Point> points_;
  std::vector<std::uint8_t> covered_;
  std::vector<std::uint32_t> order_;
};

}  // namespace vrc
