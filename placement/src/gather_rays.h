// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "core/sobol.h"
#include "hit_light.h"
#include "placement/gather.h"
#include "placement/guide.h"
#include "sampling_square.h"
#include "transport/lobe_jets.h"

namespace vrc {

/// A scalar with its derivatives, not divided by it, per channel, summed over rays; sixteen partial sums.
/// `Jet` is TiltingJet where the record's surface bends.
template <template <typename> typename Jet>
struct RgbSum16 {
  V3x16 value{};
  Jet<V3x16> jet{};

  RgbSum16& operator+=(const RgbSum16& o) {
    value += o.value;
    jet = sum(jet, o.jet);
    return *this;
  }
};
using RgbJet16 = RgbSum16<UnitJet>;
using RgbTiltingJet16 = RgbSum16<TiltingJet>;

/// c j, j the unit jet of c.
[[nodiscard]] inline RgbJet16 product(const V3x16& c, const UnitJet16& j) {
  return {c, {c * j.g1, c * j.g2, c * j.h11, c * j.h12, c * j.h22}};
}

/// The product of c j with a factor that has derivatives per channel.
[[nodiscard]] inline RgbJet16 product(const V3x16& c, const UnitJet16& j, const RgbJet16& factor) {
  const V3x16& v = factor.value;
  const UnitJet<V3x16>& f = factor.jet;
  return {
      c * v,
      {c * (v * j.g1 + f.g1), c * (v * j.g2 + f.g2), c * (v * j.h11 + f.g1 * (2.0f * j.g1) + f.h11),
       c * (v * j.h12 + f.g1 * j.g2 + f.g2 * j.g1 + f.h12), c * (v * j.h22 + f.g2 * (2.0f * j.g2) + f.h22)}};
}
[[nodiscard]] inline RgbTiltingJet16 product(const V3x16& c, const TiltingJet16& j, const RgbJet16& factor) {
  const RgbJet16 moved = product(c, j.moved, factor);
  const V3x16 &v = moved.value, c1 = c * factor.jet.g1, c2 = c * factor.jet.g2;
  return {v,
          {moved.jet, v * j.n1, v * j.n2, v * j.x11 + c1 * j.n1, v * j.x12 + c1 * j.n2, v * j.x21 + c2 * j.n1,
           v * j.x22 + c2 * j.n2, v * j.m11, v * j.m12, v * j.m22}};
}

/// Sixteen gather rays of which some met a lit surface.
struct GatherPacket16 {
  V3x16 direction;      ///< Unit.
  F16 inverse_density;  ///< Of the rays per solid angle; 0 in lanes that found nothing.
  F16 u1, u2;           ///< Points of the sampling square that the directions come from.
  F16 warp_density;     ///< What a guide contributed to the density.
  F16 distance;         ///< To the hit; infinite without one.
  I16 triangle;         ///< Of the hit.
  V3x16
      tangent_plane;  ///< n_y / (n_y . (y - x)): times a direction, 1 / distance on the hit's tangent plane.
  MovingPoint16 moving;
  UnitJet16 facing;   ///< Of -n_y . (y - x): the cosine at the hit times the distance.
  RgbJet16 incident;  ///< Radiance that the hit sends back, derivatives divided by nothing.
};

/// The rays of one record's gather.
class GatherRays {
 public:
  /// `warp`, unless null, is one for the site's BRDF. It must outlive the rays.
  GatherRays(const Scene& scene, const RecordSite& site, const GatherOptions& options, RayCounts& counts,
             const GuideWarp* warp = nullptr);

  /// Calls body(packet) for all packets of the gather that found light.
  template <typename Body>
  void for_each_packet(const Body& body) {
    for_each_packet(body, [](F16, F16, const GatherPacket16&) {});
  }
  /// And note(u1, u2, packet) for all packets; u1, u2 are the coordinates of their points in the Sobol grid.
  template <typename Body, typename Note>
  void for_each_packet(const Body& body, const Note& note) {
    static thread_local SobolGrid grid;  // storage only: filled anew for every record
    fill_sobol_grid(grid, options_.log2_rays, sobol_seed_);
    for (std::size_t i = 0; i < grid.size(); i += kLanes) {
      const auto [u] = grid.packet(i);
      GatherPacket16 packet;
      const F16 density = choose_direction(u[0], u[1], packet);
      if (trace(density, u[2], u[3], static_cast<std::uint32_t>(i), packet)) body(packet);
      note(u[0], u[1], packet);
    }
  }

  /// Traces the packet's directions, which were chosen with `density` per solid angle; `u1` and `u2` choose
  /// the light at the hits, `first_index` names the rays for further bounces. False when no ray found a
  /// surface that reflects: then only what is said of the hit up to `tangent_plane` is set.
  bool trace(F16 density, F16 u1, F16 u2, std::uint32_t first_index, GatherPacket16& packet);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const SamplingSquare& square() const { return square_; }
  [[nodiscard]] const Bsdf& bsdf() const { return square_.bsdf(); }
  [[nodiscard]] const RecordFrame& frame() const { return frame_; }
  /// Whether the derivatives follow normals that turn.
  [[nodiscard]] bool tilts() const { return tilts_; }
  /// Rays traced.
  [[nodiscard]] double ray_count() const { return static_cast<double>(rays_); }
  /// The pair of directions at the record, of which one is incident.
  [[nodiscard]] Directions16 directions_at_record(const GatherPacket16& packet) const {
    return square_.with_camera(packet.direction);
  }
  /// Fills in the distances of the hits.
  void describe_hits(HitDistances& hits) const;

 private:
  /// Chooses the packet's directions by points of the unit square, which the guide moves; returns their
  /// density per solid angle.
  F16 choose_direction(F16 u1, F16 u2, GatherPacket16& packet) const;
  [[nodiscard]] V3x16 to_frame(const V3x16& v) const;
  /// Lanes whose hit is no wall beside the record but the hollow that it lies in (`in_hollow_`).
  [[nodiscard]] I16 in_own_hollow(const V3x16& direction, const SurfacePoint16& hit) const;
  void note_distances(const GatherPacket16& packet, const SurfacePoint16& hit);
  void add_reflection(const SurfacePoint16& hit, const ArrivingLight16& light, GatherPacket16& packet) const;

  const Scene& scene_;
  const GatherOptions& options_;
  RayCounts& counts_;
  SamplingSquare square_;
  const GuideWarp* warp_;
  HitLight light_;
  RecordFrame frame_;
  V3x16 geometric_normal_, origin_;
  bool tilts_ = false;
  bool in_hollow_ = false;   ///< The derivatives follow a surface that is concave in all directions.
  float facet_ = 0.0f;       ///< Longest edge of the record's triangle.
  std::int32_t region_ = 0;  ///< The record's smooth region.
  std::uint64_t sobol_seed_ = 0;
  std::size_t rays_ = 0;

  F16 nearest_ = splat(std::numeric_limits<float>::infinity());
  V3x16 nearest_direction_{}, nearest_normal_{};
  F16 inverse_distance_{};
};

/// Sum of the lanes in double precision.
[[nodiscard]] inline double lane_total(F16 v) {
  double sum = 0.0;
  for (int i = 0; i < kLanes; ++i) sum += v[i];
  return sum;
}

}  // namespace vrc
