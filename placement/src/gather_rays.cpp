// SPDX-License-Identifier: GPL-3.0-or-later
#include "gather_rays.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/hash.h"

namespace vrc {
namespace {

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

}  // namespace

GatherRays::GatherRays(const Scene& scene, const RecordSite& site, const GatherOptions& options,
                       RayCounts& counts, const GuideWarp* warp)
    : scene_(scene),
      options_(options),
      counts_(counts),
      square_(scene.bsdfs()[static_cast<std::size_t>(site.point.material)], options.directions,
              site.frame.normal, site.to_camera.normalized()),
      warp_(warp),
      light_(scene, options, static_cast<std::uint32_t>(hash(options.seed, site.key, 0x9a7u)), counts),
      sobol_seed_(hash(options.seed, site.key)) {
  frame_.x = site.point.position.cast<float>();
  frame_.tangent = site.frame.tangent.cast<float>();
  frame_.bitangent = site.frame.bitangent.cast<float>();
  frame_.normal = site.frame.normal.cast<float>();
  frame_.to_camera = site.to_camera.cast<float>();
  frame_.shape_operator = followed_shape_operator(site, options).cast<float>();
  frame_.masking_moves = options.total_derivative;
  in_hollow_ = is_hollow(followed_shape_operator(site, options));
  const SceneTriangle& own = scene.triangles()[site.point.triangle];
  tilts_ = options.total_derivative && own.smooth != 0;
  facet_ = longest_edge(own);
  region_ = own.region;
  geometric_normal_ = splat3(site.point.geometric_normal);
  // Off the surface and towards the camera: in a crease the second keeps the origin in the open.
  const Vec3 lift =
      scene.radius() * (1e-5 * site.point.geometric_normal + 2e-5 * site.to_camera.normalized());
  origin_ = splat3(Vec3(site.point.position + lift));
}

F16 GatherRays::choose_direction(F16 u1, F16 u2, GatherPacket16& packet) const {
  packet.warp_density = splat(1.0f);
  if (warp_ != nullptr) {
    const GuideWarp::Point16 warped = (*warp_)(u1, u2);
    u1 = warped.u1;
    u2 = warped.u2;
    packet.warp_density = warped.density;
  }
  packet.u1 = u1;
  packet.u2 = u2;
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
  packet.triangle = hit.triangle;
  note_distances(packet, hit);
  const V3x16 to_hit = hit.position - splat3(frame_.x);
  const F16 height = -max(-dot(hit.geometric_normal, to_hit), 1e-5f * hit.t);
  packet.tangent_plane = select(hit.hit, hit.geometric_normal * (1.0f / height), V3x16{});
  const I16 lit = hit.scatters;
  if (!any(lit)) return false;

  const V3x16 r = select(lit, to_hit, square_.normal());
  packet.moving = moving_point(frame_, r);
  light_.for_each(lit, hit, -packet.direction, u1, u2, first_index,
                  [&](const ArrivingLight16& light) { add_reflection(hit, light, packet); });

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

/// Adds the radiance that the hits reflect, with its glossy-glossy jet.
void GatherRays::add_reflection(const SurfacePoint16& hit, const ArrivingLight16& light,
                                GatherPacket16& packet) const {
  const MovingPoint16& moving = packet.moving;
  RgbJet16& incident = packet.incident;
  const Directions16 d = directions(hit.normal, -packet.direction, light.direction);
  FixedReflector16 y;
  y.n = to_frame(hit.normal);
  y.light = to_frame(light.direction);
  y.nr = -max(dot(y.n, V3x16{-moving.r1, -moving.r2, -moving.nr}), 1e-20f);
  y.light_cos = d.cos_i;
  y.light_r = y.light.x * moving.r1 + y.light.y * moving.r2 + y.light.z * moving.nr;
  for_each_distinct(light.active, hit.material, [&](I16 mask, std::size_t id) {
    for (const Lobe& lobe : scene_.bsdfs()[id].lobes) {
      std::visit(
          [&](const auto& l) {
            const V3x16 reflected = select(mask, light.radiance * tint(l, d) * shape(l, d), V3x16{});
            if (options_.glossy_glossy)
              incident += product(reflected, masked(mask, reflector_jet(l, y, moving)));
            else
              incident.value += reflected;
          },
          lobe);
    }
  });
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
