// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "placement/guide.h"
#include "placement/place_records.h"

namespace vrc {

/// Histograms of cheap gathers on a lattice of pixels: guides where there are no records.
[[nodiscard]] GuideField guides_of_view(const Scene& scene, const PlacementView& view, int bounces,
                                        std::uint64_t seed, RayCounts& counts);

inline constexpr int kFewestLog2PixelRays = 7;

/// Estimates the indirect radiance of a pixel without records: guided gather rays from the points that its
/// camera samples see. Const and thread-safe; the guides must outlive it.
class PixelGatherer {
 public:
  PixelGatherer(const Scene& scene, const GuideField& guides, int bounces, std::uint64_t seed)
      : scene_(scene), guides_(guides), bounces_(bounces), seed_(seed) {}

  /// What was prepared for the surfaces that pixels of a tile show, for their neighbours.
  class Surfaces {
   private:
    friend class PixelGatherer;
    struct Kind {
      std::int32_t material;
      bool bends;  ///< Made of several points' BRDFs.
      Vec3 position, normal;
      std::unique_ptr<const GuideWarp> warp;  ///< Null: no record near it.
    };
    std::vector<Kind> kinds_;
  };

  /// Sum over the lanes that scatter of their outgoing radiance towards the camera, by 2^log2_rays rays for
  /// all of them together, at least kFewestLog2PixelRays. Unbiased; gathers of different keys are
  /// independent.
  [[nodiscard]] std::array<double, 3> gather(std::span<const SurfacePoint16> points, int log2_rays,
                                             std::uint64_t key, Surfaces& surfaces, RayCounts& counts) const;

 private:
  /// `views`: with the normals and the camera of some of the points of a surface that bends; none of a flat
  /// one.
  [[nodiscard]] const GuideWarp* warp_for(const RecordSite& site, std::span<const Directions16> views,
                                          Surfaces& surfaces) const;

  const Scene& scene_;
  const GuideField& guides_;
  int bounces_;
  std::uint64_t seed_;
};

}  // namespace vrc
