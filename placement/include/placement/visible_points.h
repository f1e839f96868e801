// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "placement/chart_points.h"
#include "placement/place_records.h"

namespace vrc {

/// Points of the surfaces that the camera sees, in an order of which every beginning is spread over
/// the picture, and which of them the records cover.
class VisiblePoints {
 public:
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  /// Points at the beginning that are spread as widely as the pilot records should be.
  [[nodiscard]] std::size_t pilot_count() const { return pilot_count_; }

  [[nodiscard]] bool is_open(std::size_t i) const { return covered_[i] == 0; }
  [[nodiscard]] SurfacePoint surface_point(std::size_t i) const;
  [[nodiscard]] Vec3 position(std::size_t i) const { return points_[i].position.cast<double>(); }
  [[nodiscard]] std::int32_t region(std::size_t i) const { return points_[i].region; }
  /// Of the random numbers of a record at this point.
  [[nodiscard]] std::uint64_t key(std::size_t i) const { return points_[i].key; }

  /// When the pixel of this point is shaded line by line, `turn_of`; 0 for points that are no pixels.
  [[nodiscard]] std::uint32_t turn(std::size_t i) const { return points_[i].turn; }

  /// Marks the points that the region reaches with a joint distance below 1, from `turn` on.
  void cover(const ValidRegion& region, const SurfaceReach& reach, std::uint32_t turn = 0);
  /// Counts a point as covered whatever its record's region: a record may move away from its point.
  void take(std::size_t i) { covered_[i] = 1; }
  void clear_coverage();

  /// Calls body(index, a, b, k2) for the open points that the region reaches within joint distance
  /// `support`: offsets along its axes in units of its radii, and the squared distance.
  template <typename Body>
  void for_each_open(const ValidRegion& region, const SurfaceReach& reach, double support,
                     const Body& body) const {
    for_each_within(region, reach, support, [&](std::uint32_t i, float a, float b, float k2) {
      if (covered_[i] == 0) body(i, a, b, k2);
    });
  }

 private:
  friend VisiblePoints pixel_centres(const SceneCharts&, const PlacementView&, std::uint64_t&);
  friend VisiblePoints film_points(const SceneCharts&, const PlacementView&, std::uint64_t&);

  struct Point {
    Vec3f position, normal;
    std::uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
    std::int32_t region = -1;
    std::uint64_t key = 0;
    std::uint32_t turn = 0;
  };
  class Collector;

  VisiblePoints(const SceneCharts& charts, std::vector<Point> points, std::size_t pilot_count);
  template <typename Body>
  void for_each_within(const ValidRegion& region, const SurfaceReach& reach, double support,
                       const Body& body) const;

  const SceneCharts* charts_;
  std::vector<Point> points_;
  std::vector<std::uint8_t> covered_;
  std::size_t pilot_count_ = 0;
  ChartPoints grid_;
};

/// The points behind the pixel centres, in the order of ever finer square lattices of pixels.
[[nodiscard]] VisiblePoints pixel_centres(const SceneCharts& charts, const PlacementView& view,
                                          std::uint64_t& camera_rays);

/// The points behind a Sobol sequence over the film, which knows no pixels: half as many.
[[nodiscard]] VisiblePoints film_points(const SceneCharts& charts, const PlacementView& view,
                                        std::uint64_t& camera_rays);

template <typename Body>
void VisiblePoints::for_each_within(const ValidRegion& region, const SurfaceReach& reach, double support,
                                    const Body& body) const {
  const Vec3f center = region.center.cast<float>(), normal = region.normal.cast<float>();
  const Vec3f a = (region.axis1 / region.radius1).cast<float>(),
              b = (region.axis2 / region.radius2).cast<float>(),
              c = (region.normal / region.normal_radius).cast<float>();
  const auto inverse_deviation = static_cast<float>(region.inverse_deviation());
  // Where normals do not count in the distance, they only must not turn by more than theta_max.
  const auto most_turn = region.normals_count ? std::numeric_limits<float>::infinity()
                                              : static_cast<float>(1.0 - region.cos_max_deviation);
  const auto limit = static_cast<float>(support * support);
  for (const PatchBox& box : reach.boxes) {
    grid_.for_each_near(box, [&](std::uint32_t i) {
      const Point& p = points_[i];
      const Vec3f d = p.position - center;
      const float ka = d.dot(a), kb = d.dot(b), kc = d.dot(c);
      const float turn = std::max(0.0f, 1.0f - p.normal.dot(normal));
      const float k2 = ka * ka + kb * kb + kc * kc + turn * inverse_deviation;
      if (k2 < limit && turn <= most_turn && reach.contains(p.triangle)) body(i, ka, kb, k2);
    });
  }
}

}  // namespace vrc
