// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/radiance_cache.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace vrc {
namespace {

/// A polynomial in d and in tau, what the normal turns beyond `s` d, as one in d and in all that it turns.
TiltingJet<double> by_turn(const Jet2& jet, const TiltJet& tilt, const Mat2& s) {
  const Vec2 &g = jet.gradient, &n = tilt.gradient;
  const Mat2 &h = jet.hessian, &x = tilt.mixed, &m = tilt.hessian;
  TiltingJet<double> j = {{g[0], g[1], h(0, 0), h(0, 1), h(1, 1)}, n[0], n[1]};
  j.x11 = x(0, 0);
  j.x12 = x(0, 1);
  j.x21 = x(1, 0);
  j.x22 = x(1, 1);
  j.m11 = m(0, 0);
  j.m12 = m(0, 1);
  j.m22 = m(1, 1);
  return along_surface<double>(j, -s(0, 0), -s(0, 1), -s(1, 1));
}

bool tilts(const RadianceRecord& record) {
  return !record.uses_harmonics() && std::ranges::any_of(record.tilt, [](const TiltJet& t) {
    return !(t.gradient.isZero(0.0) && t.mixed.isZero(0.0) && t.hessian.isZero(0.0));
  });
}

}  // namespace

PackedRecord pack(const RadianceRecord& record) {
  const ValidRegion& r = record.region;
  PackedRecord p;
  p.center = r.center.cast<float>();
  p.normal = r.normal.cast<float>();
  p.scaled1 = (r.axis1 / r.radius1).cast<float>();
  p.scaled2 = (r.axis2 / r.radius2).cast<float>();
  p.scaled_normal = (r.normal / r.normal_radius).cast<float>();
  p.radius1 = static_cast<float>(r.radius1);
  p.radius2 = static_cast<float>(r.radius2);
  p.cos_max_deviation = static_cast<float>(r.cos_max_deviation);
  p.split_sphere = r.split_sphere;
  p.inverse_deviation = static_cast<float>(r.inverse_deviation());
  const ValidRegion widest = turned_widest(r);
  p.cos_widest_deviation = static_cast<float>(widest.cos_max_deviation);
  p.inverse_widest = static_cast<float>(widest.inverse_deviation());
  p.reach = std::max(p.radius1, p.radius2);
  // Derivatives per unit of (a, b), the offsets divided by the radii: they have radiance's unit.
  const auto in_frame = [&](const Vec3& axis, double radius) -> Vec2 {
    return Vec2(axis.dot(record.site.frame.tangent), axis.dot(record.site.frame.bitangent)) * radius;
  };
  const Vec2 a = in_frame(r.axis1, r.radius1), b = in_frame(r.axis2, r.radius2);
  p.tilts = tilts(record);
  const Mat2 shape_operator = p.tilts ? record.site.point.shape_operator : Mat2::Zero();
  for (std::size_t c = 0; c < 3; ++c) {
    const TiltingJet<double> j = by_turn(record.radiance[c], record.tilt[c], shape_operator);
    const Vec2 gradient(j.moved.g1, j.moved.g2);
    Mat2 hessian;
    hessian << j.moved.h11, j.moved.h12, j.moved.h12, j.moved.h22;
    p.value[c] = static_cast<float>(record.radiance[c].value);
    p.g1[c] = static_cast<float>(gradient.dot(a));
    p.g2[c] = static_cast<float>(gradient.dot(b));
    p.h11[c] = static_cast<float>(a.dot(hessian * a));
    p.h12[c] = static_cast<float>(a.dot(hessian * b));
    p.h22[c] = static_cast<float>(b.dot(hessian * b));
    if (!p.tilts) continue;
    p.n1[c] = static_cast<float>(j.n1);
    p.n2[c] = static_cast<float>(j.n2);
    p.x11[c] = static_cast<float>(a[0] * j.x11 + a[1] * j.x21);
    p.x12[c] = static_cast<float>(a[0] * j.x12 + a[1] * j.x22);
    p.x21[c] = static_cast<float>(b[0] * j.x11 + b[1] * j.x21);
    p.x22[c] = static_cast<float>(b[0] * j.x12 + b[1] * j.x22);
    p.m11[c] = static_cast<float>(j.m11);
    p.m12[c] = static_cast<float>(j.m12);
    p.m22[c] = static_cast<float>(j.m22);
  }
  if (p.tilts) {
    p.tan_max_deviation =
        static_cast<float>(std::sqrt(1.0 / (r.cos_max_deviation * r.cos_max_deviation) - 1.0));
    p.tangent = record.site.frame.tangent.cast<float>();
    p.bitangent = record.site.frame.bitangent.cast<float>();
  }
  if (record.uses_harmonics()) p.harmonics = &record.harmonics->incident;
  for (int i = 0; i < 2; ++i) {
    p.in_frame[0][i] = static_cast<float>(a[i]);
    p.in_frame[1][i] = static_cast<float>(b[i]);
  }
  p.gradient_factor = static_cast<float>(record.gradient_factor);
  p.hessian_factor = static_cast<float>(record.hessian_factor);
  p.variance = static_cast<float>(record.variance() + record.misfit);
  p.turn = record.turn;
  return p;
}

Coverage16 coverage(const PackedRecord& record, const V3x16& x, const V3x16& n, I16 applies, float support,
                    Deviation deviation) {
  const V3x16 d = x - splat3(record.center);
  Coverage16 c;
  c.a = dot(d, splat3(record.scaled1));
  c.b = dot(d, splat3(record.scaled2));
  const F16 along_normal = dot(d, splat3(record.scaled_normal));
  const F16 kr = dot(n, splat3(record.normal));
  if (record.tilts) {
    const F16 inverse = 1.0f / max(kr, kLeastTiltCosine);
    c.m1 = dot(n, splat3(record.tangent)) * inverse;
    c.m2 = dot(n, splat3(record.bitangent)) * inverse;
  }
  const bool widest = deviation == Deviation::kWidest;
  const F16 kt2 = (c.a * c.a + c.b * c.b + along_normal * along_normal) * (1.0f / (support * support));
  const F16 k =
      sqrt(kt2 + max(1.0f - kr, 0.0f) * (widest ? record.inverse_widest : record.inverse_deviation));
  const I16 inside = applies & (kr >= (widest ? record.cos_widest_deviation : record.cos_max_deviation));
  if (record.split_sphere) {
    c.weight =
        select(inside, max(1.0f / max(k, static_cast<float>(kSmallestSplitDistance)) - 1.0f, 0.0f), F16{});
    return c;
  }
  const F16 kr2 = kr * kr, kr4 = kr2 * kr2, kr8 = kr4 * kr4;
  c.weight = select(inside, max(1.0f - k * kr, 0.0f) * (kr8 * kr8), F16{});
  return c;
}

Coverage16 drawn_in(const PackedRecord& record, const Coverage16& c, float most) {
  const auto at_most = [](F16 size, float limit) { return min(limit / max(size, 1e-20f), 1.0f); };
  const F16 share = at_most(sqrt(c.a * c.a + c.b * c.b), most);
  Coverage16 result = {c.a * share, c.b * share, F16{}, F16{}, c.weight};
  if (record.tilts) {
    const F16 turned = at_most(sqrt(c.m1 * c.m1 + c.m2 * c.m2), most * record.tan_max_deviation);
    result.m1 = c.m1 * turned;
    result.m2 = c.m2 * turned;
  }
  return result;
}

V3x16 extrapolate(const PackedRecord& record, const Coverage16& c, int order) {
  const F16 aa = 0.5f * c.a * c.a, ab = c.a * c.b, bb = 0.5f * c.b * c.b;
  const auto channel = [&](int i) {
    F16 v = splat(record.value[i]);
    if (order >= 1) v += c.a * record.g1[i] + c.b * record.g2[i];
    if (order >= 2) v += aa * record.h11[i] + ab * record.h12[i] + bb * record.h22[i];
    if (record.tilts && order >= 1) v += c.m1 * record.n1[i] + c.m2 * record.n2[i];
    if (record.tilts && order >= 2) {
      v += c.m1 * (c.a * record.x11[i] + c.b * record.x21[i] + 0.5f * c.m1 * record.m11[i]) +
           c.m2 * (c.a * record.x12[i] + c.b * record.x22[i] + 0.5f * c.m2 * record.m22[i]) +
           c.m1 * c.m2 * record.m12[i];
    }
    return max(v, 0.0f);
  };
  return {channel(0), channel(1), channel(2)};
}

V3x16 extrapolate(const PackedRecord& record, const Eigen::MatrixXf& weights, const Coverage16& c,
                  int order) {
  const F16 d1 = c.a * record.in_frame[0][0] + c.b * record.in_frame[1][0];
  const F16 d2 = c.a * record.in_frame[0][1] + c.b * record.in_frame[1][1];
  const auto channel = [&](int i) {
    const auto s = record.harmonics->weighted(i, weights.col(i).data());
    F16 v = splat(s[0]);
    if (order >= 1) v += record.gradient_factor * (d1 * s[1] + d2 * s[2]);
    if (order >= 2)
      v += record.hessian_factor * (0.5f * d1 * d1 * s[3] + d1 * d2 * s[4] + 0.5f * d2 * d2 * s[5]);
    return max(v, 0.0f);
  };
  return {channel(0), channel(1), channel(2)};
}

RadianceCache::RadianceCache(std::shared_ptr<const SceneCharts> charts, std::vector<RadianceRecord> records,
                             std::span<const SurfaceReach> reaches,
                             std::shared_ptr<const BrdfHarmonicsSet> brdfs)
    : charts_(std::move(charts)), records_(std::move(records)), brdfs_(std::move(brdfs)) {
  VRC_CHECK(reaches.size() == records_.size(), "{} reaches of {} records", reaches.size(), records_.size());
  packed_.reserve(records_.size());
  std::vector<PatchFootprint> boxes;
  for (std::uint32_t i = 0; i < records_.size(); ++i) {
    packed_.push_back(pack(records_[i]));
    VRC_CHECK(!records_[i].uses_harmonics() || brdfs_ != nullptr, "record {} has no BRDFs", i);
    const SurfaceReach& reach = reaches[i];
    VRC_CHECK(slots_.size() + reach.slots.size() < kInvalidIndex, "the records reach too many triangles");
    for (const PatchBox& box : reach.boxes) {
      boxes.push_back({static_cast<std::uint32_t>(footprints_.size()), box.patch, box.low, box.high});
      Footprint f;
      f.record = i;
      f.patch = static_cast<std::int32_t>(box.patch);
      // Points are located in single precision.
      const double slack = 1e-6 * (box.low.cwiseAbs().maxCoeff() + box.high.cwiseAbs().maxCoeff());
      for (int axis = 0; axis < 2; ++axis) {
        f.low[axis] = static_cast<float>(box.low[axis] - slack);
        f.high[axis] = static_cast<float>(box.high[axis] + slack);
      }
      f.first_slot = static_cast<std::uint32_t>(slots_.size());
      f.slot_mask = reach.slots.empty() ? 0 : static_cast<std::uint32_t>(reach.slots.size() - 1);
      footprints_.push_back(f);
    }
    slots_.insert(slots_.end(), reach.slots.begin(), reach.slots.end());
  }
  index_ = std::make_unique<const RegionIndex>(charts_->patch_count(), boxes);
}

I16 RadianceCache::on_reached_triangle(const Footprint& f, I16 active, I16 triangle) const {
  const std::uint32_t* slots = slots_.data() + f.first_slot;
  I16 result{};
  for_each_distinct(active, triangle, [&](I16 mask, std::size_t id) {
    if (in_hash_slots(slots, f.slot_mask, static_cast<std::uint32_t>(id))) result |= mask;
  });
  return result;
}

}  // namespace vrc
