// SPDX-License-Identifier: GPL-3.0-or-later
#include "gather_rays.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/hash.h"

namespace vrc {
namespace {

constexpr float kSharpReflector = 300.0f;  // Phong exponent from which light is sampled by the BRDF, too
constexpr float kGlossyReflector = 2.0f;   // from which a point of the lights is chosen from several
constexpr int kLightPoints = 8;            // of the lattice that (1, 3) / 8 generates
constexpr float kLightLattice = 3.0f;
constexpr double kSaddle = 0.3;  // convex curvature over concave one, of a hollow; cylinders are noisy

/// Whether the surface is concave in all directions, about.
bool is_hollow(const Mat2& shape_operator) {
  const Vec2 principal = shape_operator.selfadjointView<Eigen::Lower>().eigenvalues();
  return principal[0] < 0.0 && principal[1] <= -kSaddle * principal[0];
}

float longest_edge(const SceneTriangle& triangle) {
  const Vec3f e1(triangle.e1), e2(triangle.e2);
  return std::max({e1.norm(), e2.norm(), (e2 - e1).norm()});
}

UnitJet16 masked(I16 mask, const UnitJet16& j) {
  const F16 zero{};
  return {select(mask, j.g1, zero), select(mask, j.g2, zero), select(mask, j.h11, zero),
          select(mask, j.h12, zero), select(mask, j.h22, zero)};
}

/// In [0, 1), by hashing.
F16 random_of(F16 u1, F16 u2) {
  return to_unit_interval(mix32(std::bit_cast<U16>(bits(u1)) * 0x9e3779b9u + std::bit_cast<U16>(bits(u2))));
}

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

GatherRays::GatherRays(const Scene& scene, const RecordSite& site, const GatherOptions& options,
                       RayCounts& counts, const GuideWarp* warp)
    : scene_(scene),
      options_(options),
      counts_(counts),
      square_(scene.bsdfs()[static_cast<std::size_t>(site.point.material)], options.directions,
              site.frame.normal, site.to_camera.normalized()),
      warp_(warp),
      sobol_seed_(hash(options.seed, site.key)) {
  frame_.x = site.point.position.cast<float>();
  frame_.tangent = site.frame.tangent.cast<float>();
  frame_.bitangent = site.frame.bitangent.cast<float>();
  frame_.normal = site.frame.normal.cast<float>();
  frame_.to_camera = site.to_camera.cast<float>();
  frame_.shape_operator = followed_shape_operator(site, options).cast<float>();
  in_hollow_ = is_hollow(followed_shape_operator(site, options));
  const SceneTriangle& own = scene.triangles()[site.point.triangle];
  facet_ = longest_edge(own);
  region_ = own.region;
  geometric_normal_ = splat3(site.point.geometric_normal);
  // Off the surface and towards the camera: in a crease the second keeps the origin in the open.
  const Vec3 lift =
      scene.radius() * (1e-5 * site.point.geometric_normal + 2e-5 * site.to_camera.normalized());
  origin_ = splat3(Vec3(site.point.position + lift));
  path_seed_ = static_cast<std::uint32_t>(hash(options.seed, site.key, 0x9a7u));
}

F16 GatherRays::choose_direction(F16 u1, F16 u2, GatherPacket16& packet) const {
  packet.warp_density = splat(1.0f);
  if (warp_ != nullptr) {
    const GuideWarp::Point16 warped = (*warp_)(u1, u2);
    u1 = warped.u1;
    u2 = warped.u2;
    packet.warp_density = warped.density;
  }
  packet.cell = guide_cells(u1, u2);
  packet.direction = square_.direction(u1, u2);
  return square_.pdf(directions_at_record(packet)) * packet.warp_density;
}

bool GatherRays::trace(F16 density, F16 u1, F16 u2, std::uint32_t first_index, GatherPacket16& packet) {
  const I16 active = (dot(packet.direction, square_.normal()) > 0.0f) &
                     (dot(packet.direction, geometric_normal_) > 0.0f) & (density > 1e-20f);
  const SurfacePoint16 hit =
      scene_.intersect(active, {origin_, packet.direction, splat(1e17f)}, RayTracer::Coherence::kCoherent);
  counts_.gather += lane_count(active);
  rays_ += kLanes;
  packet.distance = select(hit.hit, hit.t, splat(std::numeric_limits<float>::infinity()));
  note_distances(packet, hit);
  const V3x16 to_hit = hit.position - splat3(frame_.x);
  const F16 height = -max(-dot(hit.geometric_normal, to_hit), 1e-5f * hit.t);
  packet.tangent_plane = select(hit.hit, hit.geometric_normal * (1.0f / height), V3x16{});
  const I16 lit = hit.scatters;
  if (!any(lit)) return false;

  const V3x16 r = select(lit, to_hit, square_.normal());
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
  return {dot(v, splat3(frame_.tangent)), dot(v, splat3(frame_.bitangent)), dot(v, square_.normal())};
}

/// In a sphere a chord of length t makes the angle asin(kappa t / 2) with the surface at both its ends: the
/// geometry term is constant, and hits near the record tell nothing of how far its derivatives hold. What
/// rises at most twice as steeply belongs to the hollow; facets turn by kappa times their length.
I16 GatherRays::in_own_hollow(const V3x16& direction, const SurfacePoint16& hit) const {
  const V3x16 d = to_frame(direction);
  const Eigen::Matrix2f& s = frame_.shape_operator;
  const F16 bend = -(s(0, 0) * d.x * d.x + 2.0f * s(0, 1) * d.x * d.y + s(1, 1) * d.y * d.y) /
                   max(d.x * d.x + d.y * d.y, 1e-20f);
  const F16 most = bend * (hit.t + facet_);
  return (hit.region == region_) & (d.z < most) & (-dot(direction, hit.geometric_normal) < most);
}

void GatherRays::note_distances(const GatherPacket16& packet, const SurfacePoint16& hit) {
  inverse_distance_ += 1.0f / max(packet.distance, 1e-30f);
  I16 nearer = packet.distance < nearest_;
  if (in_hollow_ && any(nearer)) nearer &= ~in_own_hollow(packet.direction, hit);
  nearest_ = select(nearer, packet.distance, nearest_);
  nearest_direction_ = select(nearer, packet.direction, nearest_direction_);
  nearest_normal_ = select(nearer, hit.geometric_normal, nearest_normal_);
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

/// Half of the light at sharp reflectors is sampled by their BRDFs instead of by the lights; the balance
/// heuristic weighs all samples as those of one density [Veach1997].
void GatherRays::add_direct_light(I16 active, const SurfacePoint16& hit, F16 u1, F16 u2,
                                  GatherPacket16& packet) {
  const I16 sharp = reflectors(active, hit.material, kSharpReflector);
  const I16 by_lobe = sharp & (u1 < 0.5f);
  const F16 left = select(sharp, select(by_lobe, 2.0f * u1, 2.0f * u1 - 1.0f), u1);
  add_sampled_light(active & ~by_lobe, sharp, hit, left, u2, packet);
  if (any(by_lobe)) add_met_light(by_lobe, hit, left, u2, packet);
}

/// Lanes with a lobe of at least this sharpness, where lights have an extent.
I16 GatherRays::reflectors(I16 active, I16 material, float sharpness) const {
  I16 result{};
  if (!scene_.lights().can_be_met()) return result;
  for_each_distinct(active, material, [&](I16 mask, std::size_t id) {
    if (scene_.bsdfs()[id].sharpness() >= sharpness) result |= mask;
  });
  return result;
}

void GatherRays::add_met_light(I16 active, const SurfacePoint16& hit, F16 u1, F16 u2,
                               GatherPacket16& packet) {
  const V3x16 back = -packet.direction;
  const V3x16 m = sample_bsdf(scene_.bsdfs(), active, hit.material, hit.normal, back, u1, u2);
  const Directions16 d = directions(hit.normal, back, m);
  const F16 pdf = evaluate_bsdf(scene_.bsdfs(), active, hit.material, d).pdf;
  active &= (dot(m, hit.geometric_normal) > 0.0f) & (d.cos_i > 0.0f) & (pdf > 1e-20f);
  if (!any(active)) return;
  const SurfacePoint16 next =
      scene_.intersect(active, {scene_.lifted(hit), m, splat(1e17f)}, RayTracer::Coherence::kCoherent);
  counts_.shadow += lane_count(active);
  const MetLight16 met = scene_.lights().met(active, next.hit, next.light, m, next.t, d.cos_i);
  const F16 density = 0.5f * (pdf + met.pdf);
  add_reflection(active & met.valid, hit, m, met.radiance * (1.0f / max(density, 1e-20f)), packet);
}

LightSample16 GatherRays::sample_light(const SurfacePoint16& hit, F16 u1, F16 u2) const {
  LightSample16 light = scene_.lights().sample(hit.position, hit.normal, u1, u2);
  light.valid &=
      (dot(light.direction, hit.geometric_normal) > 0.0f) & (dot(light.direction, hit.normal) > 0.0f);
  return light;
}

/// One of the points of a lattice, with probabilities in proportion to what the hits reflect of their light
/// [Talbot2005]: the noise of many points for one shadow ray.
LightSample16 GatherRays::choose_light(I16 active, const SurfacePoint16& hit, const V3x16& back, F16 u1,
                                       F16 u2) const {
  constexpr float kStep = 1.0f / static_cast<float>(kLightPoints);
  // (u1, u2) is one of the points; which one it is tells nothing of where they lie.
  const F16 number = floor(u1 * static_cast<float>(kLightPoints));
  F16 choice = (number + random_of(u1, u2)) * kStep;
  LightSample16 chosen{};
  F16 total{}, chosen_weight{};
  for (int k = 0; k < kLightPoints; ++k) {
    const F16 steps = (static_cast<float>(k) - number) * kStep;
    const F16 v2 = u2 + kLightLattice * steps;
    const LightSample16 light = sample_light(hit, within_unit(u1 + steps), within_unit(v2 - floor(v2)));
    const I16 valid = active & light.valid;
    if (!any(valid)) continue;
    const F16 weight = reflected_luminance(scene_.bsdfs(), valid, hit.material,
                                           directions(hit.normal, back, light.direction), light.radiance);
    total += weight;
    const F16 share = weight / max(total, 1e-30f);
    const I16 taken = valid & (choice < share);
    choice = select(taken, choice / max(share, 1e-20f), (choice - share) / max(1.0f - share, 1e-20f));
    chosen_weight = select(taken, weight, chosen_weight);
    chosen = select(taken, light, chosen);
  }
  chosen.radiance = chosen.radiance * (kStep * total / max(chosen_weight, 1e-30f));
  return chosen;
}

/// `shared` lanes are those whose light is sampled by their BRDFs, too.
void GatherRays::add_sampled_light(I16 active, I16 shared, const SurfacePoint16& hit, F16 u1, F16 u2,
                                   GatherPacket16& packet) {
  if (!any(active)) return;
  const V3x16 back = -packet.direction;
  const I16 choosing =
      options_.choose_light ? reflectors(active & ~shared, hit.material, kGlossyReflector) : I16{};
  LightSample16 light{};
  if (any(choosing)) light = choose_light(choosing, hit, back, u1, u2);
  if (const I16 others = active & ~choosing; any(others))
    light = select(others, sample_light(hit, u1, u2), light);
  const I16 candidate = active & light.valid;
  if (!any(candidate)) return;
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
