// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "placement/harmonics_derivatives.h"
#include "placement_support.h"

namespace vrc::test {

/// Gathers in spherical harmonics of one order.
struct HarmonicsOfScene {
  const Scene& scene;
  HarmonicsGatherer gatherer;
  BrdfHarmonicsSet brdfs;

  HarmonicsOfScene(const Scene& s, int order) : scene(s), gatherer(order), brdfs(s.bsdfs(), order) {}

  [[nodiscard]] IncidentHarmonics incident(const RecordSite& site, int log2_rays, std::uint64_t seed,
                                           GatherDirections directions = GatherDirections::kMixture,
                                           HarmonicsGatherer::NoiseSums* noise = nullptr) const {
    GatherOptions options;
    options.log2_rays = log2_rays;
    options.seed = seed;
    options.directions = directions;
    RayCounts counts;
    HitDistances hits;
    return gatherer.gather(scene, site, options, counts, hits, noise);
  }
  [[nodiscard]] const BrdfHarmonics& brdf(const RecordSite& site) const {
    return brdfs.of(static_cast<std::size_t>(site.point.material));
  }
  /// Luminance towards the camera, the weights of the BRDF staying as they are.
  [[nodiscard]] Jet2 luminance_of(const IncidentHarmonics& incident, const RecordSite& site) const {
    Eigen::MatrixXf weights(incident.count(), 3);
    brdf(site).response(site.point.normal, site.to_camera.normalized(), weights);
    return luminance(outgoing_radiance(incident, weights));
  }
};

}  // namespace vrc::test
