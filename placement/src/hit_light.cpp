// SPDX-License-Identifier: GPL-3.0-or-later
#include "hit_light.h"

#include <bit>

#include "weighted_choice.h"

namespace vrc {
namespace {

constexpr float kGlossyReflector = 2.0f;  // Phong exponent from which a point of the lights is one of several
constexpr int kLightPoints = 8;           // of the lattice that (1, 3) / 8 generates
constexpr float kLightLattice = 3.0f;

/// The luminance of f cos_i, times radiance that arrives.
F16 reflected_luminance(const std::vector<Bsdf>& bsdfs, I16 active, I16 material, const Directions16& d,
                        const V3x16& radiance) {
  F16 result{};
  for_each_distinct(active, material, [&](I16 mask, std::size_t id) {
    result = select(mask, luminance(f_cos(bsdfs[id], d) * radiance), result);
  });
  return result;
}

}  // namespace

/// Lanes with a lobe of at least this sharpness, where lights have an extent.
I16 HitLight::reflectors(I16 active, I16 material, float sharpness) const {
  I16 result{};
  if (!scene_.lights().can_be_met()) return result;
  for_each_distinct(active, material, [&](I16 mask, std::size_t id) {
    if (scene_.bsdfs()[id].sharpness() >= sharpness) result |= mask;
  });
  return result;
}

ArrivingLight16 HitLight::met(I16 active, const SurfacePoint16& hit, const V3x16& back, F16 u1,
                              F16 u2) const {
  if (!any(active)) return {};
  const V3x16 m = sample_bsdf(scene_.bsdfs(), active, hit.material, hit.normal, back, u1, u2);
  const Directions16 d = directions(hit.normal, back, m);
  const F16 pdf = evaluate_bsdf(scene_.bsdfs(), active, hit.material, d).pdf;
  active &= (dot(m, hit.geometric_normal) > 0.0f) & (d.cos_i > 0.0f) & (pdf > 1e-20f);
  if (!any(active)) return {};
  const SurfacePoint16 next =
      scene_.intersect(active, {scene_.lifted(hit), m, splat(1e17f)}, RayTracer::Coherence::kCoherent);
  counts_.shadow += lane_count(active);
  const MetLight16 met = scene_.lights().met(active, next.hit, next.light, m, next.t, d.cos_i);
  const F16 density = 0.5f * (pdf + met.pdf);
  return {active & met.valid, m, met.radiance * (1.0f / max(density, 1e-20f))};
}

LightSample16 HitLight::sample_light(const SurfacePoint16& hit, F16 u1, F16 u2) const {
  LightSample16 light = scene_.lights().sample(hit.position, hit.normal, u1, u2);
  light.valid &=
      (dot(light.direction, hit.geometric_normal) > 0.0f) & (dot(light.direction, hit.normal) > 0.0f);
  return light;
}

/// One of the points of a lattice, with probabilities in proportion to what the hits reflect of their light
/// [Talbot2005]: the noise of many points for one shadow ray.
LightSample16 HitLight::choose_light(I16 active, const SurfacePoint16& hit, const V3x16& back, F16 u1,
                                     F16 u2) const {
  constexpr float kStep = 1.0f / static_cast<float>(kLightPoints);
  // (u1, u2) is one of the points; which one it is tells nothing of where they lie.
  const F16 number = floor(u1 * static_cast<float>(kLightPoints));
  WeightedChoice16 choice((number + random_of(u1, u2)) * kStep);
  LightSample16 chosen{};
  for (int k = 0; k < kLightPoints; ++k) {
    const F16 steps = (static_cast<float>(k) - number) * kStep;
    const F16 v2 = u2 + kLightLattice * steps;
    const LightSample16 light = sample_light(hit, within_unit(u1 + steps), within_unit(v2 - floor(v2)));
    const I16 valid = active & light.valid;
    if (!any(valid)) continue;
    const F16 weight = reflected_luminance(scene_.bsdfs(), valid, hit.material,
                                           directions(hit.normal, back, light.direction), light.radiance);
    chosen = select(choice.offer(weight), light, chosen);
  }
  chosen.radiance = chosen.radiance * (kStep * choice.total() / max(choice.chosen(), 1e-30f));
  return chosen;
}

ArrivingLight16 HitLight::sampled(I16 active, I16 shared, const SurfacePoint16& hit, const V3x16& back,
                                  F16 u1, F16 u2) const {
  if (!any(active)) return {};
  const I16 choosing =
      options_.choose_light ? reflectors(active & ~shared, hit.material, kGlossyReflector) : I16{};
  LightSample16 light{};
  if (any(choosing)) light = choose_light(choosing, hit, back, u1, u2);
  if (const I16 others = active & ~choosing; any(others))
    light = select(others, sample_light(hit, u1, u2), light);
  const I16 candidate = active & light.valid;
  if (!any(candidate)) return {};
  const I16 blocked =
      scene_.tracer().occluded(candidate, scene_.shadow_ray(hit, light), RayTracer::Coherence::kCoherent);
  counts_.shadow += lane_count(candidate);
  if (any(shared)) {
    const Directions16 d = directions(hit.normal, back, light.direction);
    const F16 pdf = evaluate_bsdf(scene_.bsdfs(), candidate & shared, hit.material, d).pdf;
    // Light of no extent (pdf 0) is met by no ray.
    const F16 share = select(light.pdf > 0.0f, 0.5f + 0.5f * pdf / max(light.pdf, 1e-30f), splat(0.5f));
    light.radiance = light.radiance * select(shared, 1.0f / share, splat(1.0f));
  }
  return {candidate & ~blocked, light.direction, light.radiance};
}

ArrivingLight16 HitLight::bounced(I16 active, const SurfacePoint16& hit, const V3x16& back,
                                  std::uint32_t first_index) const {
  const PathSampler16 sampler = {std::bit_cast<U16>(lane_index()) + first_index, splat(seed_)};
  const Sample4 u = sampler.vertex(0);
  const V3x16 m = sample_bsdf(scene_.bsdfs(), active, hit.material, hit.normal, back, u.u[0], u.u[1]);
  const BsdfValue16 bsdf =
      evaluate_bsdf(scene_.bsdfs(), active, hit.material, directions(hit.normal, back, m));
  active &= (dot(m, hit.geometric_normal) > 0.0f) & (bsdf.pdf > 1e-20f);
  if (!any(active)) return {};
  const SurfacePoint16 next =
      scene_.intersect(active, {scene_.lifted(hit), m, splat(1e17f)}, RayTracer::Coherence::kIncoherent);
  counts_.other += lane_count(active);
  const PathSampler16 further = {sampler.index, splat(seed_ ^ 0x5bd1e995u)};
  const int left = options_.bounces < 0 ? -1 : options_.bounces - 2;
  const V3x16 radiance = reflected_radiance(scene_, next, m, active & next.hit, further, left, counts_);
  return {active, m, radiance * (1.0f / max(bsdf.pdf, 1e-20f))};
}

}  // namespace vrc
