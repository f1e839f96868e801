// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/scene_reader.h"
#include "placement/gather.h"
#include "placement/radiance_cache.h"
#include "transport/film_sampler.h"

namespace vrc::test {

inline Scene load_scene(const std::string& name, int width, int height,
                        const std::map<std::string, std::string>& defines = {}) {
  SceneReadOptions options;
  options.defines = defines;
  options.width = width;
  options.height = height;
  return Scene(read_scene(std::string(VRC_SOURCE_DIR "/scenes/") + name, options));
}

/// Sites at given film positions, as shares of the film's size; all must see a surface.
inline std::vector<RecordSite> sites_at(const Scene& scene, const std::vector<Vec2>& shares) {
  std::vector<RecordSite> sites;
  for (const Vec2& s : shares) {
    const auto point = scene.seen_at(s[0] * scene.camera().width, s[1] * scene.camera().height);
    EXPECT_TRUE(point.has_value()) << s.transpose();
    if (point) sites.push_back(make_site(scene, *point, 1000 + sites.size()));
  }
  return sites;
}

inline RadianceEstimate gather(const Scene& scene, const RecordSite& site, int log2_rays, std::uint64_t seed,
                               bool glossy_glossy = true, int bounces = 1) {
  RayCounts counts;
  GatherOptions options;
  options.log2_rays = log2_rays;
  options.seed = seed;
  options.glossy_glossy = glossy_glossy;
  options.bounces = bounces;
  return gather_radiance(scene, site, options, counts);
}

/// (value, g1, g2, h11, h12, h22).
inline std::vector<double> entries(const Jet2& j) {
  return {j.value, j.gradient[0], j.gradient[1], j.hessian(0, 0), j.hessian(0, 1), j.hessian(1, 1)};
}

}  // namespace vrc::test
