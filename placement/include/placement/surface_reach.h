// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/surface_walker.h"
#include "placement/scene_charts.h"
#include "placement/valid_region.h"

namespace vrc {

/// An open-addressing table of numbers; its size is a power of two, and kInvalidIndex marks free slots.
[[nodiscard]] std::vector<std::uint32_t> make_hash_slots(std::span<const std::uint32_t> numbers);
[[nodiscard]] inline std::uint32_t first_hash_slot(std::uint32_t number) {
  return (number * 0x9e3779b1u) >> 7;
}
[[nodiscard]] inline bool in_hash_slots(const std::uint32_t* slots, std::uint32_t mask,
                                        std::uint32_t number) {
  for (std::uint32_t i = first_hash_slot(number) & mask;; i = (i + 1) & mask) {
    if (slots[i] == number) return true;
    if (slots[i] == kInvalidIndex) return false;
  }
}

/// A box in the (u, v) of a patch of SceneCharts.
struct PatchBox {
  std::uint32_t patch = 0;
  Vec2 low = Vec2::Zero();
  Vec2 high = Vec2::Zero();
};

/// The part of a scene's surfaces that a region reaches without crossing a crease or a gap.
struct SurfaceReach {
  std::vector<PatchBox> boxes;       ///< In rising order of the patches.
  std::vector<std::uint32_t> slots;  ///< Hash slots of the triangles; empty: all of the patches.

  /// For triangles of the patches only.
  [[nodiscard]] bool contains(std::uint32_t triangle) const {
    return slots.empty() ||
           in_hash_slots(slots.data(), static_cast<std::uint32_t>(slots.size() - 1), triangle);
  }
};

/// The region's ellipse, widened `support` times, on the mesh of the surface that holds the point.
[[nodiscard]] SurfaceEllipse surface_ellipse(const Scene& scene, const SurfacePoint& point,
                                             const ValidRegion& region, double support);

/// Walks from the record's point over the faces that the region, widened `support` times, can cover:
/// those within the ellipse whose normals turn by at most theta_max.
[[nodiscard]] SurfaceReach reach_over_surface(const SceneCharts& charts, const SurfacePoint& point,
                                              const ValidRegion& region, double support);

/// Largest angle between the region's normal and the shading normals inside its ellipse, as met by
/// walking over the surface, its nearest thousand faces at most. [radians]
[[nodiscard]] double walked_deviation(const SceneCharts& charts, const SurfacePoint& point,
                                      const ValidRegion& region);

}  // namespace vrc
