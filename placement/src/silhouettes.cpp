// SPDX-License-Identifier: GPL-3.0-or-later
#include "silhouettes.h"

#include <algorithm>
#include <bit>

namespace vrc {
namespace {

using Field = HitGrid::Field;

// Hits that lie off each other's tangent planes by less than this share of their distance are on one
// surface.
constexpr float kFlat = 1e-3f;
// Tangent planes seen at a grazing angle are not extrapolated farther than this times the hit's distance, nor
// nearer than the inverse of it.
constexpr float kFarthestExtrapolation = 2.0f;
// From a hit to the contact behind it, the angle is at most this times that to the silhouette that was found
// beside the hit: farther contacts are none, the surface ends before.
constexpr float kFarthestContact = 4.0f;
// Radii of curvature count as this times the hit's distance at most: flat parts know their curvature badly.
constexpr float kLargestRadius = 10.0f;
// Pieces nearer to the horizon than about this angle are left out: the cosine makes them negligible. [rad]
constexpr float kLowest = 1e-3f;
// The cells that the far surface's radiance is fitted to. Cells are several times as long across the rows
// as across the columns, so that the window is about square on the sphere.
constexpr int kWindowLoops = 5;
constexpr float kFewestCells = 4.5f;
// Successive pieces that go to the same partial sum: their errors are correlated by shared cells, and the
// spread of the partial sums must show that.
constexpr std::size_t kRun = 16;
// The fitted radiance is a share of the mean; its log-gradient divides by at least this share.
constexpr float kLeastTrend = 0.2f;

/// A corner of sixteen triangles.
struct Corners {
  V3x16 direction;
  F16 inverse_distance;
  V3x16 plane;
  I16 index;
};

V3x16 gather3(const HitGrid& grid, int first_field, I16 index) {
  const auto at = [&](int f) { return gather(grid.field(static_cast<Field>(first_field + f)), index); };
  return {at(0), at(1), at(2)};
}

Corners gather_corners(const HitGrid& grid, I16 index) {
  return {gather3(grid, Field::kDirectionX, index), gather(grid.field(Field::kInverseDistance), index),
          gather3(grid, Field::kPlaneX, index), index};
}

/// Where neighbours in the mesh lie on different surfaces of which one hides a part of the other.
struct Jump {
  I16 found;
  I16 first_is_near;
};

inline Jump jump_between(const Corners& i, const Corners& j) {
  const F16 d0 = i.inverse_distance - dot(j.plane, i.direction);
  const F16 d1 = dot(i.plane, j.direction) - j.inverse_distance;
  const F16 least = (kFlat * kFlat) * (i.inverse_distance * j.inverse_distance);
  return {d0 * d1 > least, d0 > 0.0f};
}

/// The radiance of a far surface around one of its cells.
enum FarField {
  kMeanX,  // Mean direction of the cells that count.
  kMeanY,
  kMeanZ,
  kMeanR,  // Mean radiance.
  kMeanG,
  kMeanB,
  kAcrossX,  // Log-gradient of its luminance over directions.
  kAcrossY,
  kAcrossZ,
  kMeanSlope1,  // Mean log-gradient as the record moves.
  kMeanSlope2,
  kFarFields
};

/// Derivatives of weight (d . nu) j, and of what the normal part of d adds to it.
UnitJet<V3x16> strip(const V3x16& weight, F16 nu1, F16 nu2, F16 nun, const MovingPoint16& p,
                     const UnitJet16& j) {
  return {weight * nu1, weight * nu2, weight * (2.0f * j.g1 * nu1 - nun * p.s11),
          weight * (j.g1 * nu2 + j.g2 * nu1 - nun * p.s12), weight * (2.0f * j.g2 * nu2 - nun * p.s22)};
}
TiltingJet<V3x16> strip(const V3x16& weight, F16 nu1, F16 nu2, F16 nun, const MovingPoint16& p,
                        const TiltingJet16& j) {
  TiltingJet<V3x16> result;
  result.moved = strip(weight, nu1, nu2, nun, p, j.moved);
  result.x11 = weight * (nu1 * j.n1);
  result.x12 = weight * (nu1 * j.n2);
  result.x21 = weight * (nu2 * j.n1);
  result.x22 = weight * (nu2 * j.n2);
  return result;
}

/// Where sixteen pieces touch the near surface instead of an edge of it. As the record moves, the point of
/// contact slides over the surface.
struct Contacts16 {
  I16 touch{};
  F16 inverse_distance{};
  F16 radius{};    ///< 1 / k, k the surface's normal curvature along the ray; 0 without a contact. [length]
  V3x16 normal{};  ///< Of the surface at the contact: unit and perpendicular to the ray.
};

/// What the sliding adds to the Hessian. In the plane of the ray w and the normal n at the contact, the
/// tangent to a surface of curvature k, at the inverse distance a, turns by a further (d . n)^2 a^3 / 2k, so
/// that the near surface hides more of the far one however the record moves. `weight` is the difference of
/// their radiances times f cos, nu the silhouette's normal times its length, on the side of the far surface.
UnitJet<V3x16> sliding(const V3x16& weight, const Contacts16& c, const V3x16& nu, const V3x16& tangent,
                       const V3x16& bitangent) {
  const F16 a = c.inverse_distance, n1 = dot(c.normal, tangent), n2 = dot(c.normal, bitangent);
  const V3x16 w = weight * (a * a * a * c.radius * dot(nu, c.normal));
  return {V3x16{}, V3x16{}, w * (n1 * n1), w * (n1 * n2), w * (n2 * n2)};
}

/// Straight pieces of silhouettes: found first, summed up sixteen at a time in the end.
class Pieces {
 public:
  Pieces(const HitGrid& grid, const GatherRays& rays) : grid_(grid), rays_(rays), storage_(thread_storage()) {
    n_ = splat3(rays.frame().normal);
    tangent_ = splat3(rays.frame().tangent);
    bitangent_ = splat3(rays.frame().bitangent);
    storage_.pieces.clear();
    storage_.far_cells.clear();
    storage_.slot_of_cell.assign(static_cast<std::size_t>(grid.index_end()), -1);
  }

  /// Adds the pieces that rays of a strategy found.
  void add(int strategy) {
    const HitMesh mesh(grid_, rays_.square().strategies()[static_cast<std::size_t>(strategy)]);
    // Blocks of far cells belong to one strategy.
    const std::size_t first_far = (storage_.far_cells.size() + kLanes - 1) / kLanes * kLanes;
    storage_.far_cells.resize(first_far);
    for (std::size_t i = 0; i < mesh.triangle_count(); i += kLanes) {
      const auto [a, b, c] = mesh.triangles(i);
      const I16 valid = lane_index() < static_cast<int>(mesh.triangle_count() - i);
      add_triangles(strategy, valid, gather_corners(grid_, a), gather_corners(grid_, b),
                    gather_corners(grid_, c));
    }
    fit_far_surfaces(mesh, first_far);
  }

  /// Adds the pieces inside sixteen triangles, counter-clockwise as seen from outside the sphere.
  void add_triangles(int strategy, I16 valid, const Corners& a, const Corners& b, const Corners& c) {
    const Jump jumps[3] = {jump_between(a, b), jump_between(b, c), jump_between(c, a)};
    const I16 found[3] = {jumps[0].found & valid, jumps[1].found & valid, jumps[2].found & valid};
    if (!any(found[0] | found[1] | found[2])) return;
    const I16 count = -(found[0] + found[1] + found[2]);
    const V3x16 middles[3] = {normalize(a.direction + b.direction), normalize(b.direction + c.direction),
                              normalize(c.direction + a.direction)};
    V3x16 sum{};
    for (int e = 0; e < 3; ++e) sum += select(found[e], middles[e], V3x16{});
    const V3x16 centre = normalize(select(count == 1, a.direction + b.direction + c.direction, sum));
    const Corners* corner[4] = {&a, &b, &c, &a};
    for (int e = 0; e < 3; ++e) {
      const V3x16& m = middles[e];
      // A sky behind the silhouette sends no indirect light.
      const I16 lit =
          select(jumps[e].first_is_near, corner[e + 1]->inverse_distance, corner[e]->inverse_distance) > 0.0f;
      for (std::uint32_t left = mask_bits(found[e] & lit); left != 0; left &= left - 1) {
        const int lane = std::countr_zero(left);
        const bool first_is_near = jumps[e].first_is_near[lane] != 0;
        const int first = corner[e]->index[lane], second = corner[e + 1]->index[lane];
        storage_.pieces.push_back({first_is_near ? first : second,
                                   slot_of(first_is_near ? second : first, strategy),
                                   first_is_near ? -1.0f : 1.0f,
                                   {m.x[lane], m.y[lane], m.z[lane]},
                                   {centre.x[lane], centre.y[lane], centre.z[lane]}});
      }
    }
  }

  template <template <typename> typename Jet>
  [[nodiscard]] Jet<V3x16> total() const {
    Jet<V3x16> total;
    for (std::size_t begin = 0; begin < storage_.pieces.size(); begin += kLanes * kRun) {
      for (std::size_t k = 0; k < kRun; ++k) add_strips(begin + k, total);
    }
    return total;
  }

 private:
  struct Piece {
    int near;      // Cell of the near surface.
    int far_slot;  // Of its neighbour, in `far_cells`.
    float side;    // -1 where the near cell is the first of the edge's corners, 1 where the second.
    float begin[3], end[3];
  };
  struct FarCell {
    int cell, strategy;
  };
  struct Storage {
    std::vector<Piece> pieces;
    std::vector<FarCell> far_cells;
    std::vector<int> slot_of_cell;
    std::vector<float> far_values;  // kFarFields blocks of sixteen for every sixteen far cells
  };
  static Storage& thread_storage() {
    static thread_local Storage storage;
    return storage;
  }

  [[nodiscard]] int slot_of(int cell, int strategy) {
    int& slot = storage_.slot_of_cell[static_cast<std::size_t>(cell)];
    if (slot < 0) {
      slot = static_cast<int>(storage_.far_cells.size());
      storage_.far_cells.push_back({cell, strategy});
    }
    return slot;
  }

  /// Of the far cells from `first` on.
  void fit_far_surfaces(const HitMesh& mesh, std::size_t first) {
    const std::size_t count = storage_.far_cells.size();
    storage_.far_values.resize((count + kLanes) * kFarFields);
    for (std::size_t begin = first; begin < count; begin += kLanes) {
      I16 cells{};
      for (int lane = 0; lane < kLanes; ++lane)
        cells[lane] = storage_.far_cells[std::min(begin + static_cast<std::size_t>(lane), count - 1)].cell;
      fit_far_surface(mesh, cells, storage_.far_values.data() + begin * kFarFields);
    }
  }

  /// A plane through the luminance over the cells around the given ones, on the same surfaces and inside the
  /// strategies' meshes; its gradient is divided by the value at the mean direction.
  void fit_far_surface(const HitMesh& mesh, I16 centre, float* out) const {
    const V3x16 plane = gather3(grid_, Field::kPlaneX, centre);
    const V3x16 origin = gather3(grid_, Field::kDirectionX, centre);
    const Tangents16 e = tangents(origin);
    F16 n{}, u{}, v{}, uu{}, uv{}, vv{}, l{}, ul{}, vl{}, slope1{}, slope2{};
    V3x16 radiance{}, direction{};
    const auto take = [&](I16 inside, I16 cells) {
      const I16 index = select(inside, cells, centre);
      const V3x16 o = gather3(grid_, Field::kDirectionX, index);
      const F16 inverse = gather(grid_.field(Field::kInverseDistance), index);
      const I16 counts = inside & ((abs(dot(plane, o) - inverse) < kFlat * inverse) | (index == centre));
      if (!any(counts)) return;
      const V3x16 rgb = select(counts, gather3(grid_, Field::kRadianceR, index), V3x16{});
      const F16 lum = luminance(rgb);
      const F16 ou = select(counts, dot(o, e.s), F16{}), ov = select(counts, dot(o, e.t), F16{});
      n += select(counts, splat(1.0f), F16{});
      direction += select(counts, o, V3x16{});
      radiance += rgb;
      u += ou;
      v += ov;
      uu += ou * ou;
      uv += ou * ov;
      vv += ov * ov;
      l += lum;
      ul += ou * lum;
      vl += ov * lum;
      slope1 += lum * gather(grid_.field(Field::kSlope1), index);
      slope2 += lum * gather(grid_.field(Field::kSlope2), index);
    };
    const auto take_loop = [&](I16 inside, I16 cells) {
      if (!any(inside)) return;
      take(inside, cells);
      const I16 readable = select(inside, cells, centre);
      take(inside, mesh.neighbours(HitMesh::kNext, readable));
      take(inside, mesh.neighbours(HitMesh::kPrevious, readable));
    };
    take_loop(splat(-1), centre);
    for (const HitMesh::Link across : {HitMesh::kInner, HitMesh::kOuter}) {
      I16 cells = centre;
      I16 inside = splat(-1);
      for (int step = 0; step < kWindowLoops; ++step) {
        cells = mesh.neighbours(across, select(inside, cells, centre));
        inside &= cells >= 0;
        take_loop(inside, cells);
      }
    }
    const F16 inverse_n = 1.0f / n;
    const F16 inverse_l = select(l > 1e-20f, 1.0f / max(l, 1e-20f), F16{});
    const F16 cuu = uu - u * u * inverse_n, cuv = uv - u * v * inverse_n, cvv = vv - v * v * inverse_n;
    const F16 cul = ul - u * l * inverse_n, cvl = vl - v * l * inverse_n;
    const F16 determinant = cuu * cvv - cuv * cuv;
    const I16 determined = (n > kFewestCells) & (determinant > 1e-3f * cuu * cvv) & (determinant > 1e-20f);
    const F16 scale = select(determined, n * inverse_l / max(determinant, 1e-20f), F16{});
    const V3x16 across = e.s * ((cvv * cul - cuv * cvl) * scale) + e.t * ((cuu * cvl - cuv * cul) * scale);
    const V3x16 mean_direction = direction * inverse_n, mean_radiance = radiance * inverse_n;
    const F16 values[kFarFields] = {mean_direction.x, mean_direction.y,   mean_direction.z,  mean_radiance.x,
                                    mean_radiance.y,  mean_radiance.z,    across.x,          across.y,
                                    across.z,         slope1 * inverse_l, slope2 * inverse_l};
    for (int f = 0; f < kFarFields; ++f) __builtin_memcpy(out + f * kLanes, &values[f], sizeof(F16));
  }

  /// Adds piece `begin` and those kRun, 2 kRun, ... after it.
  template <template <typename> typename Jet>
  void add_strips(std::size_t begin, Jet<V3x16>& total) const {
    I16 valid{};
    I16 near{}, far{}, slot{}, strategy{};
    F16 side{};
    V3x16 from = n_, to = n_;
    for (int lane = 0; lane < kLanes; ++lane) {
      const std::size_t index = begin + static_cast<std::size_t>(lane) * kRun;
      if (index >= storage_.pieces.size()) break;
      valid[lane] = -1;
      const Piece& p = storage_.pieces[index];
      const FarCell& f = storage_.far_cells[static_cast<std::size_t>(p.far_slot)];
      near[lane] = p.near;
      far[lane] = f.cell;
      strategy[lane] = f.strategy;
      slot[lane] = (p.far_slot / kLanes) * (kLanes * kFarFields) + p.far_slot % kLanes;
      side[lane] = p.side;
      from.x[lane] = p.begin[0];
      from.y[lane] = p.begin[1];
      from.z[lane] = p.begin[2];
      to.x[lane] = p.end[0];
      to.y[lane] = p.end[1];
      to.z[lane] = p.end[2];
    }
    const I16 up = valid & (dot(from + to, n_) > kLowest);
    const V3x16 w = normalize(select(up, from + to, n_));
    const V3x16 nu = cross(w, to - from) * side;
    const auto of_far = [&](int field) { return gather(storage_.far_values.data() + field * kLanes, slot); };
    const auto of_far3 = [&](int field) {
      return V3x16{of_far(field), of_far(field + 1), of_far(field + 2)};
    };
    const V3x16 across = of_far3(kAcrossX);
    // The fitted radiance at w; as far from the mean as the edge of the cells that it was fitted to.
    const F16 trend = min(max(1.0f + dot(across, w - of_far3(kMeanX)), 0.0f), 3.0f);
    const V3x16 radiance = select(up, of_far3(kMeanR) * trend, V3x16{});

    const F16 at_hit = gather(grid_.field(Field::kInverseDistance), near);
    const V3x16 near_plane = gather3(grid_, Field::kPlaneX, near);
    const Contacts16 contacts = contacts_at(up, near, at_hit, near_plane, w);
    const F16 a = select(contacts.touch, contacts.inverse_distance,
                         min(max(dot(near_plane, w), at_hit * (1.0f / kFarthestExtrapolation)),
                             at_hit * kFarthestExtrapolation));
    const F16 b = max(dot(gather3(grid_, Field::kPlaneX, far), w), 0.0f);
    const Directions16 d = rays_.square().with_camera(w);
    const F16 balance = balance_weight(strategy, d);
    // Points of the strip lie on the far surface (b - s) d from where the fixed hits are.
    const F16 lag = 0.5f * (b - a) / max(trend, kLeastTrend);
    const F16 far1 = of_far(kMeanSlope1) + lag * dot(across, tangent_);
    const F16 far2 = of_far(kMeanSlope2) + lag * dot(across, bitangent_);
    const F16 nu1 = dot(nu, tangent_), nu2 = dot(nu, bitangent_), nun = dot(nu, n_);
    const F16 mean = max(0.5f * (a + b), 1e-12f);
    const MovingPoint16 moving = moving_point(rays_.frame(), w * (1.0f / mean));
    UnitJet16 others = pow(moving.jet_rr, -2.0f);
    others.g1 += far1;
    others.g2 += far2;
    const V3x16 swept = radiance * (a - b);
    V3x16 responses{};
    for (const Lobe& lobe : rays_.bsdf().lobes) {
      std::visit(
          [&](const auto& l) {
            const V3x16 response = tint(l, d) * (shape(l, d) * balance);
            responses += response;
            total = sum(total, strip(swept * response, nu1, nu2, nun, moving,
                                     shape_jet<Jet<F16>>(l, moving) * others));
          },
          lobe);
    }
    if (any(contacts.touch)) {
      const V3x16 covered = select(up, gather3(grid_, Field::kRadianceR, near) - radiance, V3x16{});
      total = sum(sliding(covered * responses, contacts, nu, tangent_, bitangent_), total);
    }
  }

  /// Of pieces in the directions w beside near cells, whose hits and tangent planes are given.
  [[nodiscard]] Contacts16 contacts_at(I16 active, I16 near, F16 at_hit, const V3x16& plane,
                                       const V3x16& w) const {
    const V3x16 o = gather3(grid_, Field::kDirectionX, near);
    const V3x16 normal = -normalize(plane);
    const F16 curvature =
        rays_.scene().normal_curvature(bits(gather(grid_.field(Field::kTriangle), near)), o, normal);
    const I16 convex = active & (curvature > 0.0f);
    if (!any(convex)) return {};
    const F16 cosine = max(-dot(normal, o), 0.0f);
    const F16 radius = min(1.0f / max(curvature, 1e-20f), kLargestRadius / max(at_hit, 1e-20f));
    // In a sphere distance^2 = hit^2 + 2 hit cosine radius.
    const F16 inverse_distance =
        max(at_hit / sqrt(1.0f + 2.0f * at_hit * cosine * radius), at_hit * (1.0f / kFarthestExtrapolation));
    const V3x16 away = w - o, across = normal - w * dot(normal, w);
    const F16 angle = 0.5f * cosine * cosine * radius * inverse_distance;
    const I16 touch =
        convex & (angle < kFarthestContact * sqrt(dot(away, away))) & (dot(across, across) > 1e-6f);
    if (!any(touch)) return {};
    return {touch, select(touch, inverse_distance, F16{}), select(touch, radius, F16{}),
            select(touch, normalize(across), V3x16{})};
  }

  /// Of the strategies that the pieces were found by.
  [[nodiscard]] F16 balance_weight(I16 strategy, const Directions16& d) const {
    F16 own{}, all{};
    const auto& strategies = rays_.square().strategies();
    for (std::size_t s = 0; s < strategies.size(); ++s) {
      const F16 density = (strategies[s].end - strategies[s].begin) * rays_.square().pdf(strategies[s], d);
      all += density;
      own = select(strategy == static_cast<int>(s), density, own);
    }
    return own / max(all, 1e-30f);
  }

  const HitGrid& grid_;
  const GatherRays& rays_;
  Storage& storage_;
  V3x16 n_, tangent_, bitangent_;
};

}  // namespace

template <template <typename> typename Jet>
RgbSum16<Jet> silhouette_derivatives(const HitGrid& grid, const GatherRays& rays) {
  Pieces pieces(grid, rays);
  for (std::size_t s = 0; s < rays.square().strategies().size(); ++s) pieces.add(static_cast<int>(s));
  RgbSum16<Jet> result;
  result.jet = scaled(static_cast<float>(rays.ray_count()), pieces.total<Jet>());
  return result;
}

template RgbJet16 silhouette_derivatives(const HitGrid&, const GatherRays&);
template RgbTiltingJet16 silhouette_derivatives(const HitGrid&, const GatherRays&);

}  // namespace vrc
