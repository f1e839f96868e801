// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "placement/gather.h"

namespace vrc {

/// Light that arrives at the hits of a packet of gather rays.
struct ArrivingLight16 {
  I16 active{};
  V3x16 direction{};  ///< Unit, from the hit.
  V3x16 radiance{};   ///< Over the density of the direction.
};

/// What the hits of one gather's rays have to reflect: a sample of the direct light and, with several
/// bounces, a path's light.
class HitLight {
 public:
  /// `seed` is that of the paths. All references must outlive it.
  HitLight(const Scene& scene, const GatherOptions& options, std::uint32_t seed, RayCounts& counts)
      : scene_(scene), options_(options), counts_(counts), seed_(seed) {}

  /// Calls body(ArrivingLight16) for the parts of what arrives at the hits, of which the light that they
  /// scatter along `back` is the sum. `u1` and `u2` choose the light, `first_index` names the rays for
  /// further bounces.
  template <typename Body>
  void for_each(I16 active, const SurfacePoint16& hit, const V3x16& back, F16 u1, F16 u2,
                std::uint32_t first_index, const Body& body) const {
    const auto pass_on = [&](const ArrivingLight16& light) {
      if (any(light.active)) body(light);
    };
    // Half of the light at sharp reflectors is sampled by their BRDFs instead of by the lights; the balance
    // heuristic weighs all samples as those of one density [Veach1997].
    const I16 sharp = reflectors(active, hit.material, kSharpReflector);
    const I16 by_lobe = sharp & (u1 < 0.5f);
    const F16 left = select(sharp, select(by_lobe, 2.0f * u1, 2.0f * u1 - 1.0f), u1);
    pass_on(sampled(active & ~by_lobe, sharp, hit, back, left, u2));
    pass_on(met(by_lobe, hit, back, left, u2));
    if (options_.bounces != 1) pass_on(bounced(active, hit, back, first_index));
  }

 private:
  static constexpr float kSharpReflector = 300.0f;  // Phong exponent

  [[nodiscard]] I16 reflectors(I16 active, I16 material, float sharpness) const;
  /// `shared` lanes are those whose light is sampled by their BRDFs, too.
  [[nodiscard]] ArrivingLight16 sampled(I16 active, I16 shared, const SurfacePoint16& hit, const V3x16& back,
                                        F16 u1, F16 u2) const;
  [[nodiscard]] ArrivingLight16 met(I16 active, const SurfacePoint16& hit, const V3x16& back, F16 u1,
                                    F16 u2) const;
  [[nodiscard]] ArrivingLight16 bounced(I16 active, const SurfacePoint16& hit, const V3x16& back,
                                        std::uint32_t first_index) const;
  [[nodiscard]] LightSample16 sample_light(const SurfacePoint16& hit, F16 u1, F16 u2) const;
  [[nodiscard]] LightSample16 choose_light(I16 active, const SurfacePoint16& hit, const V3x16& back, F16 u1,
                                           F16 u2) const;

  const Scene& scene_;
  const GatherOptions& options_;
  RayCounts& counts_;
  std::uint32_t seed_;
};

}  // namespace vrc
