// SPDX-License-Identifier: GPL-3.0-or-later
#include "silhouettes.h"

#include <algorithm>
#include <array>
#include <bit>

namespace vrc {
namespace {

using Field = HitGrid::Field;

// Hits that lie off each other's tangent planes by less than this share of their distance are on one
// surface.
constexpr float kFlat = 1e-3f;
// Tangent planes seen at a grazing angle are not extrapolated farther than this times the hit's distance.
constexpr float kFarthestExtrapolation = 2.0f;

F16 load(const float* p) {
  F16 v;
  __builtin_memcpy(&v, p, sizeof(v));
  return v;
}

/// One corner of sixteen cells.
struct Corners {
  V3x16 direction;
  F16 inverse_distance;
  V3x16 plane;
  I16 index;
};

Corners load_corners(const HitGrid& grid, int index) {
  const auto at = [&](int f) { return load(grid.field(static_cast<Field>(f)) + index); };
  return {{at(Field::kDirectionX), at(Field::kDirectionY), at(Field::kDirectionZ)},
          at(Field::kInverseDistance),
          {at(Field::kPlaneX), at(Field::kPlaneY), at(Field::kPlaneZ)},
          lane_index() + index};
}

V3x16 gather3(const HitGrid& grid, int first_field, I16 index) {
  const auto at = [&](int f) { return gather(grid.field(static_cast<Field>(first_field + f)), index); };
  return {at(0), at(1), at(2)};
}

Corners gather_corners(const HitGrid& grid, I16 index) {
  return {gather3(grid, Field::kDirectionX, index), gather(grid.field(Field::kInverseDistance), index),
          gather3(grid, Field::kPlaneX, index), index};
}

/// Where neighbours in the grid lie on different surfaces of which one hides a part of the other.
struct Jump {
  I16 found;
  I16 first_is_near;
  V3x16 middle;  ///< Unit; of the edge between the two.
};

Jump jump_between(const Corners& i, const Corners& j) {
  const F16 d0 = i.inverse_distance - dot(j.plane, i.direction);
  const F16 d1 = dot(i.plane, j.direction) - j.inverse_distance;
  const F16 least = (kFlat * kFlat) * (i.inverse_distance * j.inverse_distance);
  return {d0 * d1 > least, d0 > 0.0f, normalize(i.direction + j.direction)};
}

/// Straight pieces of silhouettes, sixteen at a time.
class Pieces {
 public:
  Pieces(const HitGrid& grid, const GatherRays& rays) : grid_(grid), rays_(rays) {
    n_ = splat3(rays.frame().normal);
    tangent_ = splat3(rays.frame().tangent);
    bitangent_ = splat3(rays.frame().bitangent);
  }

  /// The pieces inside sixteen triangles, counter-clockwise as seen from outside the sphere.
  void add_triangles(int strategy, I16 valid, const Corners& a, const Corners& b, const Corners& c,
                     const std::array<Jump, 3>& jumps) {
    const I16 found[3] = {jumps[0].found & valid, jumps[1].found & valid, jumps[2].found & valid};
    const I16 some = found[0] | found[1] | found[2];
    if (!any(some)) return;
    const I16 count = -(found[0] + found[1] + found[2]);
    V3x16 middle{};
    for (int e = 0; e < 3; ++e) middle += select(found[e], jumps[e].middle, V3x16{});
    const V3x16 centre =
        normalize(select(count == 1, a.direction + b.direction + c.direction, middle));
    const I16 corner[4] = {a.index, b.index, c.index, a.index};
    for (int e = 0; e < 3; ++e) {
      for (std::uint32_t left = mask_bits(found[e]); left != 0; left &= left - 1) {
        const int lane = std::countr_zero(left);
        const bool first_is_near = jumps[e].first_is_near[lane] != 0;
        const int first = corner[e][lane], second = corner[e + 1][lane];
        const int k = count_++;
        near_[k] = first_is_near ? first : second;
        far_[k] = first_is_near ? second : first;
        side_[k] = first_is_near ? -1.0f : 1.0f;
        strategy_[k] = strategy;
        begin_.x[k] = jumps[e].middle.x[lane];
        begin_.y[k] = jumps[e].middle.y[lane];
        begin_.z[k] = jumps[e].middle.z[lane];
        end_.x[k] = centre.x[lane];
        end_.y[k] = centre.y[lane];
        end_.z[k] = centre.z[lane];
        if (count_ == kLanes) sum_up();
      }
    }
  }

  [[nodiscard]] RgbJet16 total() {
    sum_up();
    return sum_;
  }

 private:
  /// Adds the stored pieces to the sum.
  void sum_up() {
    const I16 valid = lane_index() < count_;
    count_ = 0;
    if (!any(valid)) return;
    const I16 near = select(valid, near_, I16{}), far = select(valid, far_, I16{});
    const V3x16 radiance = select(valid, gather3(grid_, Field::kRadianceR, far), V3x16{});
    const V3x16 w = normalize(begin_ + end_);
    const V3x16 nu = cross(w, end_ - begin_) * side_;
    const F16 near_distance = gather(grid_.field(Field::kInverseDistance), near);
    const F16 a =
        max(dot(gather3(grid_, Field::kPlaneX, near), w), near_distance * (1.0f / kFarthestExtrapolation));
    const F16 b = max(dot(gather3(grid_, Field::kPlaneX, far), w), 0.0f);
    const F16 mean = max(0.5f * (a + b), 1e-12f);

    const Directions16 d = rays_.directions_at_record(w);
    const F16 swept = (a - b) * balance_weight(d);
    const F16 nu1 = dot(nu, tangent_), nu2 = dot(nu, bitangent_), nun = dot(nu, n_);
    const MovingPoint16 moving = moving_point(rays_.frame(), w * (1.0f / mean));
    const UnitJet16 spread = pow(moving.jet_rr, -2.0f);
    const F16 slope1 = gather(grid_.field(Field::kSlope1), far);
    const F16 slope2 = gather(grid_.field(Field::kSlope2), far);
    for (const Lobe& lobe : rays_.bsdf().lobes) {
      std::visit(
          [&](const auto& l) {
            const F16 size = select(valid & (d.cos_i > 0.0f), shape(l, d) * swept, F16{});
            const V3x16 weight = radiance * tint(l, d) * size;
            const UnitJet16 jet = shape_jet(l, moving);
            const F16 p1 = jet.g1 + spread.g1 + slope1, p2 = jet.g2 + spread.g2 + slope2;
            sum_.g1 += weight * nu1;
            sum_.g2 += weight * nu2;
            sum_.h11 += weight * (2.0f * p1 * nu1 - nun * moving.s11);
            sum_.h12 += weight * (p1 * nu2 + p2 * nu1 - nun * moving.s12);
            sum_.h22 += weight * (2.0f * p2 * nu2 - nun * moving.s22);
          },
          lobe);
    }
  }

  /// Of the strategies that the pieces were found by.
  [[nodiscard]] F16 balance_weight(const Directions16& d) const {
    F16 own{}, all{};
    const auto& strategies = rays_.strategies();
    for (std::size_t s = 0; s < strategies.size(); ++s) {
      const F16 density = (strategies[s].end - strategies[s].begin) * rays_.strategy_pdf(strategies[s], d);
      all += density;
      own = select(strategy_ == static_cast<int>(s), density, own);
    }
    return own / max(all, 1e-30f);
  }

  const HitGrid& grid_;
  const GatherRays& rays_;
  V3x16 n_, tangent_, bitangent_;
  int count_ = 0;
  I16 near_{}, far_{}, strategy_{};
  F16 side_{};  // -1 where the first of the edge's corners is near
  V3x16 begin_{}, end_{};
  RgbJet16 sum_;
};

/// Sixteen quadrilaterals a, b, c, d, counter-clockwise.
void add_cells(Pieces& pieces, int strategy, I16 valid, const Corners& a, const Corners& b, const Corners& c,
               const Corners& d) {
  const Jump ab = jump_between(a, b), bc = jump_between(b, c), ca = jump_between(c, a);
  const Jump cd = jump_between(c, d), da = jump_between(d, a);
  pieces.add_triangles(strategy, valid, a, b, c, {ab, bc, ca});
  const Jump ac = {ca.found, ~ca.first_is_near, ca.middle};
  pieces.add_triangles(strategy, valid, a, c, d, {ac, cd, da});
}

}  // namespace

HitGrid::HitGrid(int columns_log2, int rows_log2)
    : columns_(1 << columns_log2),
      rows_(1 << rows_log2),
      stride_(rows_ + kLanes),
      field_size_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(stride_)),
      values_([]() -> std::vector<float>& {
        static thread_local std::vector<float> storage;
        return storage;
      }()) {
  values_.resize(kFields * field_size_);
}

void HitGrid::store(F16 u1, F16 u2, const GatherPacket16& packet) {
  const I16 slot = to_int(u1 * static_cast<float>(columns_)) * stride_ + to_int(u2 * static_cast<float>(rows_));
  const F16 brightness = luminance(packet.incident.value);
  const F16 inverse = select(brightness > 0.0f, 1.0f / max(brightness, 1e-30f), F16{});
  const F16 fields[kFields] = {packet.direction.x,
                               packet.direction.y,
                               packet.direction.z,
                               1.0f / packet.distance,
                               packet.tangent_plane.x,
                               packet.tangent_plane.y,
                               packet.tangent_plane.z,
                               packet.incident.value.x,
                               packet.incident.value.y,
                               packet.incident.value.z,
                               luminance(packet.incident.g1) * inverse,
                               luminance(packet.incident.g2) * inverse};
  for (int f = 0; f < kFields; ++f) {
    float* base = values_.data() + static_cast<std::size_t>(f) * field_size_;
    for (int lane = 0; lane < kLanes; ++lane) base[slot[lane]] = fields[f][lane];
  }
}

void HitGrid::close() {
  for (int f = 0; f < kFields; ++f) {
    float* base = values_.data() + static_cast<std::size_t>(f) * field_size_;
    for (int c = 0; c < columns_; ++c) base[index(c, rows_)] = base[index(c, 0)];
  }
}

RgbJet16 silhouette_derivatives(const HitGrid& grid, const GatherRays& rays) {
  Pieces pieces(grid, rays);
  const int rows = grid.rows();
  const auto& strategies = rays.strategies();
  const I16 all = splat(-1);
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const auto column = [&](float share) { return static_cast<int>(share * static_cast<float>(grid.columns())); };
    const int first = column(strategies[s].begin), last = column(strategies[s].end) - 1;
    const auto strategy = static_cast<int>(s);
    // The first column goes around the pole: its polygon is cut into a ladder.
    for (int row = 0; row < rows / 2 - 1; row += kLanes) {
      const I16 r = lane_index() + row;
      const I16 valid = r < rows / 2 - 1;
      const I16 a = select(valid, r, I16{}) + grid.index(first, 0);
      const I16 d = select(valid, rows - 1 - r, I16{}) + grid.index(first, 0);
      add_cells(pieces, strategy, valid, gather_corners(grid, a), gather_corners(grid, a + 1),
                gather_corners(grid, d - select(valid, splat(1), I16{})), gather_corners(grid, d));
    }
    for (int c = first; c < last; ++c) {
      for (int row = 0; row < rows; row += kLanes) {
        const int here = grid.index(c, row), beyond = grid.index(c + 1, row);
        add_cells(pieces, strategy, all, load_corners(grid, here), load_corners(grid, beyond),
                  load_corners(grid, beyond + 1), load_corners(grid, here + 1));
      }
    }
  }
  RgbJet16 sum = pieces.total();
  const F16 scale = splat(static_cast<float>(rays.ray_count()));
  for (V3x16* part : {&sum.g1, &sum.g2, &sum.h11, &sum.h12, &sum.h22}) *part = *part * scale;
  return sum;
}

}  // namespace vrc
