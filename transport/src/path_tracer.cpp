// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/path_tracer.h"

namespace vrc {
namespace {

constexpr int kRouletteDepth = 4;
constexpr int kUnboundedDepth = 4096;  // Russian roulette ends paths long before

/// Weight of a sample of density a > 0. The quotient is squared: squares of densities overflow.
F16 power_heuristic(F16 a, F16 b) {
  const F16 quotient = b / a;
  return 1.0f / (1.0f + quotient * quotient);
}

/// Light from one sampled light at p, weighted against BSDF sampling.
V3x16 sampled_light(const Scene& scene, const SurfacePoint16& p, const V3x16& wo, I16 active, F16 u1, F16 u2,
                    RayCounts& counts) {
  const LightSample16 light = scene.lights().sample(p.position, p.normal, u1, u2);
  const I16 candidate = active & light.valid & (dot(light.direction, p.geometric_normal) > 0.0f);
  if (!any(candidate)) return V3x16{};
  const BsdfValue16 bsdf =
      evaluate_bsdf(scene.bsdfs(), candidate, p.material, directions(p.normal, wo, light.direction));
  const I16 useful = candidate & (luminance(bsdf.f_cos) > 0.0f);
  if (!any(useful)) return V3x16{};
  const I16 blocked =
      scene.tracer().occluded(useful, scene.shadow_ray(p, light), RayTracer::Coherence::kCoherent);
  counts.shadow += lane_count(useful);
  const F16 weight = select(light.pdf > 0.0f, power_heuristic(light.pdf, bsdf.pdf), splat(1.0f));
  return select(useful & ~blocked, light.radiance * bsdf.f_cos * weight, V3x16{});
}

/// Emission met by a ray that left at `cosine` to the normal and was sampled with density `pdf`.
V3x16 met_emission(const Scene& scene, const SurfacePoint16& hit, I16 active, const V3x16& direction,
                   F16 cosine, F16 pdf) {
  const MetLight16 met = scene.lights().met(active, hit.hit, hit.light, direction, hit.t, cosine);
  return select(met.valid, met.radiance * power_heuristic(pdf, met.pdf), V3x16{});
}

/// Follows paths from given points; calls add(vertex, active, throughput * radiance).
/// Vertex 0 is the given point. `last` is the last vertex whose reflected direct light counts.
template <typename Add>
void follow(const Scene& scene, const SurfacePoint16& first, const V3x16& direction, I16 active,
            const PathSampler16& sampler, int last, bool first_light, RayCounts& counts, const Add& add) {
  SurfacePoint16 p = first;
  V3x16 wo = -direction;
  V3x16 throughput = {splat(1.0f), splat(1.0f), splat(1.0f)};
  active &= p.scatters;
  for (int vertex = 0; vertex <= last && any(active); ++vertex) {
    const Sample4 u = sampler.vertex(static_cast<std::uint32_t>(vertex));
    const bool wants_light = vertex > 0 || first_light;
    if (wants_light) {
      add(vertex,
          select(active, throughput * sampled_light(scene, p, wo, active, u.u[0], u.u[1], counts), V3x16{}));
    }

    const V3x16 wi = sample_bsdf(scene.bsdfs(), active, p.material, p.normal, wo, u.u[2], u.u[3]);
    const Directions16 d = directions(p.normal, wo, wi);
    const BsdfValue16 bsdf = evaluate_bsdf(scene.bsdfs(), active, p.material, d);
    active &= (dot(wi, p.geometric_normal) > 0.0f) & (bsdf.pdf > 1e-20f) & (luminance(bsdf.f_cos) > 0.0f);
    if (!any(active)) return;
    throughput = throughput * bsdf.f_cos * (1.0f / max(bsdf.pdf, 1e-20f));
    if (vertex >= kRouletteDepth) {
      const F16 survival = min(max(luminance(throughput), 0.05f), 0.95f);
      const Sample4 roulette = sampler.vertex(0x10000u + static_cast<std::uint32_t>(vertex));
      active &= roulette.u[0] < survival;
      throughput = throughput * (1.0f / survival);
    }
    const SurfacePoint16 next =
        scene.intersect(active, {scene.lifted(p), wi, splat(1e17f)}, RayTracer::Coherence::kIncoherent);
    counts.other += lane_count(active);
    if (wants_light) {
      add(vertex,
          select(active, throughput * met_emission(scene, next, active, wi, d.cos_i, bsdf.pdf), V3x16{}));
    }
    active &= next.scatters;
    wo = -wi;
    p = next;
  }
}

int last_vertex(int bounces) { return bounces < 0 ? kUnboundedDepth : bounces; }

}  // namespace

PathRadiance16 trace_paths(const Scene& scene, const SurfacePoint16& first, const V3x16& direction,
                           I16 active, const PathSampler16& sampler, const PathOptions& options,
                           RayCounts& counts) {
  PathRadiance16 result;
  if (options.direct) {
    const I16 on_light = active & first.hit & (first.light >= 0);
    if (any(on_light))
      result.direct += select(on_light, scene.lights().emitted(on_light, first.light, direction), V3x16{});
    result.direct += select(active & ~first.hit, splat3(scene.lights().environment()), V3x16{});
  }
  const int last = options.indirect ? last_vertex(options.bounces) : 0;
  follow(scene, first, direction, active & first.hit, sampler, last, options.direct, counts,
         [&](int vertex, const V3x16& radiance) {
           (vertex == 0 ? result.direct : result.indirect) += radiance;
         });
  return result;
}

V3x16 reflected_radiance(const Scene& scene, const SurfacePoint16& first, const V3x16& direction, I16 active,
                         const PathSampler16& sampler, int bounces, RayCounts& counts) {
  V3x16 result{};
  follow(scene, first, direction, active & first.hit, sampler, last_vertex(bounces), true, counts,
         [&](int, const V3x16& radiance) { result += radiance; });
  return result;
}

}  // namespace vrc
