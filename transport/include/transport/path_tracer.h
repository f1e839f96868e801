// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "core/sobol.h"
#include "transport/scene.h"

namespace vrc {

struct RayCounts {
  std::uint64_t camera = 0, gather = 0, shadow = 0, other = 0;

  RayCounts& operator+=(const RayCounts& o) {
    camera += o.camera;
    gather += o.gather;
    shadow += o.shadow;
    other += o.other;
    return *this;
  }
};

/// Number of lanes set, for counting rays.
[[nodiscard]] inline std::uint64_t lane_count(I16 mask) {
  return static_cast<std::uint64_t>(std::popcount(mask_bits(mask)));
}

/// Where the random numbers of a packet of paths come from: lane i is sample `index[i]` of the
/// sequence `seed[i]`; every vertex of the path uses a sequence of its own derived from it.
struct PathSampler16 {
  U16 index;
  U16 seed;

  [[nodiscard]] Sample4 vertex(std::uint32_t number) const {
    return padded_sobol(index, (seed ^ (number * 0x9e3779b9u)) * 0x85ebca6bu + number);
  }
};

struct PathOptions {
  int bounces = 1;       ///< Of indirect light; -1 is unbounded (Russian roulette ends the paths).
  bool indirect = true;  ///< false: stop after the direct light of the first point.
  bool direct = true;    ///< false: trace only what adds indirect light.
};

struct PathRadiance16 {
  V3x16 direct{};    ///< Emitters seen directly or in one reflection at the first point.
  V3x16 indirect{};  ///< Everything with at least two reflections.
};

/// Radiance that arrives along camera rays whose first points are given: next-event estimation and
/// BSDF sampling combined by the power heuristic [Veach1997], Russian roulette beyond four bounces.
/// `direction` is that of the camera ray (unit).
[[nodiscard]] PathRadiance16 trace_paths(const Scene& scene, const SurfacePoint16& first,
                                         const V3x16& direction, I16 active, const PathSampler16& sampler,
                                         const PathOptions& options, RayCounts& counts);

/// Radiance reflected at given points towards -direction with up to `bounces` further reflections
/// after the first: what a gather ray brings back.
[[nodiscard]] V3x16 reflected_radiance(const Scene& scene, const SurfacePoint16& first,
                                       const V3x16& direction, I16 active, const PathSampler16& sampler,
                                       int bounces, RayCounts& counts);

}  // namespace vrc
