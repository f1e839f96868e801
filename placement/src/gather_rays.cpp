// SPDX-License-Identifier: GPL-3.0-or-later
#include "gather_rays.h"

#include <algorithm>
#include <bit>

#include "core/hash.h"

namespace vrc {
namespace {

std::vector<GatherStrategy> make_strategies(const Bsdf& bsdf, GatherDirections directions) {
  using Kind = GatherStrategy::Kind;
  if (directions == GatherDirections::kUniform) return {{Kind::kUniform}};
  if (directions == GatherDirections::kCosine) return {{}};
  std::vector<const Lobe*> glossy;
  bool diffuse = false;
  for (const Lobe& lobe : bsdf.lobes) {
    if (std::holds_alternative<LambertLobe>(lobe))
      diffuse = true;
    else
      glossy.push_back(&lobe);
  }
  if (glossy.empty()) return {{}};
  const int count = std::min<int>(static_cast<int>(glossy.size()), 4);
  const int glossy_eighths = std::max(diffuse ? 2 : 4, count);
  std::vector<GatherStrategy> result = {
      {Kind::kCosine, nullptr, 0.0f, static_cast<float>(8 - glossy_eighths) / 8.0f}};
  for (int i = 0; i < count; ++i) {
    const float begin = result.back().end;
    const int share = (glossy_eighths * (i + 1)) / count - (glossy_eighths * i) / count;
    result.push_back(
        {Kind::kLobe, glossy[static_cast<std::size_t>(i)], begin, begin + static_cast<float>(share) / 8.0f});
  }
  return result;
}

UnitJet16 masked(I16 mask, const UnitJet16& j) {
  const F16 zero{};
  return {select(mask, j.g1, zero), select(mask, j.g2, zero), select(mask, j.h11, zero),
          select(mask, j.h12, zero), select(mask, j.h22, zero)};
}

}  // namespace

GatherRays::GatherRays(const Scene& scene, const RecordSite& site, const GatherOptions& options,
                       RayCounts& counts)
    : scene_(scene),
      options_(options),
      counts_(counts),
      bsdf_(scene.bsdfs()[static_cast<std::size_t>(site.point.material)]),
      strategies_(make_strategies(bsdf_, options.directions)),
      sobol_seed_(hash(options.seed, site.key)) {
  frame_.x = site.point.position.cast<float>();
  frame_.tangent = site.frame.tangent.cast<float>();
  frame_.bitangent = site.frame.bitangent.cast<float>();
  frame_.normal = site.frame.normal.cast<float>();
  frame_.to_camera = site.to_camera.cast<float>();
  frame_.shape_operator = followed_shape_operator(site, options).cast<float>();
  normal_ = splat3(frame_.normal);
  geometric_normal_ = splat3(site.point.geometric_normal);
  to_camera_ = splat3(Vec3(site.to_camera.normalized()));
  // Off the surface and towards the camera: in a crease the second keeps the origin in the open.
  const Vec3 lift =
      scene.radius() * (1e-5 * site.point.geometric_normal + 2e-5 * site.to_camera.normalized());
  origin_ = splat3(Vec3(site.point.position + lift));
  path_seed_ = static_cast<std::uint32_t>(hash(options.seed, site.key, 0x9a7u));
}

bool GatherRays::trace(F16 density, F16 u1, F16 u2, std::uint32_t first_index, GatherPacket16& packet) {
  const I16 active = (dot(packet.direction, normal_) > 0.0f) &
                     (dot(packet.direction, geometric_normal_) > 0.0f) & (density > 1e-20f);
  const SurfacePoint16 hit =
      scene_.intersect(active, {origin_, packet.direction, splat(1e17f)}, RayTracer::Coherence::kCoherent);
  counts_.gather += lane_count(active);
  rays_ += kLanes;
  packet.distance = select(hit.hit, hit.t, splat(std::numeric_limits<float>::infinity()));
  note_distances(packet, hit.geometric_normal);
  const V3x16 to_hit = hit.position - splat3(frame_.x);
  const F16 height = -max(-dot(hit.geometric_normal, to_hit), 1e-5f * hit.t);
  packet.tangent_plane = select(hit.hit, hit.geometric_normal * (1.0f / height), V3x16{});
  const I16 lit = hit.scatters;
  if (!any(lit)) return false;

  const V3x16 r = select(lit, to_hit, normal_);
  packet.moving = moving_point(frame_, r);
  add_direct_light(lit, hit, u1, u2, packet);
  if (options_.bounces != 1) add_bounced_light(lit, hit, first_index, packet);

  // The geometric normal at the hit: the surface element does not know of shading normals.
  const V3x16 ny = to_frame(hit.geometric_normal);
  const F16 s = max(-dot(hit.geometric_normal, r), 1e-6f * sqrt(packet.moving.rr));
  packet.facing = jet_of_linear(packet.moving, s, -ny.x, -ny.y, -ny.z);
  packet.inverse_density = select(lit, 1.0f / density, F16{});
  return true;
}

V3x16 GatherRays::to_frame(const V3x16& v) const {
  return {dot(v, splat3(frame_.tangent)), dot(v, splat3(frame_.bitangent)), dot(v, normal_)};
}

/// Blocks of sixteen points lie in one strategy's columns.
V3x16 GatherRays::sample_direction(F16 u1, F16 u2) const {
  const auto found =
      std::ranges::find_if(strategies_, [&](const GatherStrategy& s) { return u1[0] < s.end; });
  const GatherStrategy& s = found == strategies_.end() ? strategies_.back() : *found;
  const F16 stretched = min(max((u1 - s.begin) * (1.0f / (s.end - s.begin)), 0.0f), 0x1.fffffep-1f);
  switch (s.kind) {
    case GatherStrategy::Kind::kCosine:
      return sample(LambertLobe{}, normal_, to_camera_, stretched, u2);
    case GatherStrategy::Kind::kUniform:
      return around_axis(normal_, 1.0f - stretched, u2);
    case GatherStrategy::Kind::kLobe:
      break;
  }
  return std::visit([&](const auto& l) { return sample(l, normal_, to_camera_, stretched, u2); }, *s.lobe);
}

F16 GatherRays::strategy_pdf(const GatherStrategy& strategy, const Directions16& d) const {
  switch (strategy.kind) {
    case GatherStrategy::Kind::kCosine:
      return pdf(LambertLobe{}, d);
    case GatherStrategy::Kind::kUniform:
      return splat(static_cast<float>(0.5 / kPi));
    case GatherStrategy::Kind::kLobe:
      break;
  }
  return std::visit([&](const auto& l) { return pdf(l, d); }, *strategy.lobe);
}

F16 GatherRays::mixture_pdf(const Directions16& d) const {
  F16 sum{};
  for (const GatherStrategy& s : strategies_) sum += (s.end - s.begin) * strategy_pdf(s, d);
  return sum;
}

void GatherRays::note_distances(const GatherPacket16& packet, const V3x16& normal) {
  inverse_distance_ += 1.0f / max(packet.distance, 1e-30f);
  const I16 nearer = packet.distance < nearest_;
  nearest_ = select(nearer, packet.distance, nearest_);
  nearest_direction_ = select(nearer, packet.direction, nearest_direction_);
  nearest_normal_ = select(nearer, normal, nearest_normal_);
}

/// Adds the radiance that the hits reflect of light from directions m, with its glossy-glossy jet.
void GatherRays::add_reflection(I16 active, const SurfacePoint16& hit, const V3x16& m, const V3x16& radiance,
                                GatherPacket16& packet) const {
  const MovingPoint16& moving = packet.moving;
  RgbJet16& incident = packet.incident;
  const Directions16 d = directions(hit.normal, -packet.direction, m);
  FixedReflector16 y;
  y.n = to_frame(hit.normal);
  y.light = to_frame(m);
  y.nr = -max(dot(y.n, V3x16{-moving.r1, -moving.r2, -moving.nr}), 1e-20f);
  y.light_cos = d.cos_i;
  y.light_r = y.light.x * moving.r1 + y.light.y * moving.r2 + y.light.z * moving.nr;
  for_each_distinct(active, hit.material, [&](I16 mask, std::size_t id) {
    for (const Lobe& lobe : scene_.bsdfs()[id].lobes) {
      std::visit(
          [&](const auto& l) {
            const V3x16 reflected = select(mask, radiance * tint(l, d) * shape(l, d), V3x16{});
            if (options_.glossy_glossy)
              incident.add(reflected, masked(mask, reflector_jet(l, y, moving)));
            else
              incident.value += reflected;
          },
          lobe);
    }
  });
}

void GatherRays::add_direct_light(I16 active, const SurfacePoint16& hit, F16 u1, F16 u2,
                                  GatherPacket16& packet) {
  const LightSample16 light = scene_.lights().sample(hit.position, hit.normal, u1, u2);
  const I16 candidate = active & light.valid & (dot(light.direction, hit.geometric_normal) > 0.0f) &
                        (dot(light.direction, hit.normal) > 0.0f);
  if (!any(candidate)) return;
  const I16 blocked =
      scene_.tracer().occluded(candidate, scene_.shadow_ray(hit, light), RayTracer::Coherence::kCoherent);
  counts_.shadow += lane_count(candidate);
  add_reflection(candidate & ~blocked, hit, light.direction, light.radiance, packet);
}

void GatherRays::add_bounced_light(I16 active, const SurfacePoint16& hit, std::uint32_t first_index,
                                   GatherPacket16& packet) {
  const V3x16 back = -packet.direction;
  const PathSampler16 sampler = {std::bit_cast<U16>(lane_index()) + first_index, splat(path_seed_)};
  const Sample4 u = sampler.vertex(0);
  const V3x16 m = sample_bsdf(scene_.bsdfs(), active, hit.material, hit.normal, back, u.u[0], u.u[1]);
  const BsdfValue16 bsdf =
      evaluate_bsdf(scene_.bsdfs(), active, hit.material, directions(hit.normal, back, m));
  active &= (dot(m, hit.geometric_normal) > 0.0f) & (bsdf.pdf > 1e-20f);
  if (!any(active)) return;
  const SurfacePoint16 next =
      scene_.intersect(active, {scene_.lifted(hit), m, splat(1e17f)}, RayTracer::Coherence::kIncoherent);
  counts_.other += lane_count(active);
  const PathSampler16 further = {sampler.index, splat(path_seed_ ^ 0x5bd1e995u)};
  const int left = options_.bounces < 0 ? -1 : options_.bounces - 2;
  const V3x16 radiance = reflected_radiance(scene_, next, m, active & next.hit, further, left, counts_);
  add_reflection(active, hit, m, radiance * (1.0f / max(bsdf.pdf, 1e-20f)), packet);
}

void GatherRays::describe_hits(HitDistances& hits) const {
  int lane = 0;
  for (int i = 1; i < kLanes; ++i) {
    if (nearest_[i] < nearest_[lane]) lane = i;
  }
  const auto of_lane = [&](const V3x16& v) { return Vec3(v.x[lane], v.y[lane], v.z[lane]); };
  hits.nearest = nearest_[lane];
  hits.nearest_direction = of_lane(nearest_direction_);
  hits.nearest_normal = of_lane(nearest_normal_);
  hits.mean_inverse = lane_total(inverse_distance_) / ray_count();
}

}  // namespace vrc
