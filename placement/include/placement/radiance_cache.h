// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/simd.h"
#include "placement/record.h"

namespace vrc {

/// A record in single precision, its derivatives along the axes of its region, for sixteen-wide use.
struct PackedRecord {
  Vec3f center, normal;
  Vec3f scaled1, scaled2, scaled_normal;  ///< Axes divided by their radii.
  float radius1, radius2;
  float cos_max_deviation;
  float inverse_deviation;  ///< 1 / (1 - cos_max_deviation)
  float reach;              ///< Largest radius.
  std::int32_t region;      ///< Smooth region of the surface.
  float value[3], g1[3], g2[3], h11[3], h12[3], h22[3];
};

/// Position of sixteen points relative to a record: offsets in units of the radii, and its weight.
struct Coverage16 {
  F16 a, b;    ///< Along the two axes.
  F16 weight;  ///< As `weight(ValidRegion)`, 0 where the record does not apply.
};

/// [Zhao eq. 14-15] with the joint distance, for the points of smooth region `region`, the ellipsoid
/// widened `support` times.
[[nodiscard]] Coverage16 coverage(const PackedRecord& record, const V3x16& x, const V3x16& n, I16 region,
                                  float support);

/// The Taylor polynomial of [Zhao eq. 13].
[[nodiscard]] V3x16 extrapolate(const PackedRecord& record, const Coverage16& c, int order);

/// Records with a bounding-volume tree over their widened ellipsoids. Immutable.
class RadianceCache {
 public:
  /// Regions are used up to `max_support` times their radii.
  RadianceCache(std::vector<RadianceRecord> records, double max_support);

  [[nodiscard]] std::span<const RadianceRecord> records() const { return records_; }
  [[nodiscard]] std::span<const PackedRecord> packed() const { return packed_; }

  /// Appends the indices of all records whose widened ellipsoids may meet the box, in rising order.
  void find(const Box3& box, std::vector<std::uint32_t>& result) const;

 private:
  struct Node {
    Eigen::AlignedBox3f box;
    std::uint32_t begin, count;  ///< Leaf: a range of order_; count 0 for inner nodes.
    std::uint32_t right;         ///< Inner: the left child follows its parent.
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end, const std::vector<Eigen::AlignedBox3f>& boxes);

  std::vector<RadianceRecord> records_;
  std::vector<PackedRecord> packed_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace vrc
