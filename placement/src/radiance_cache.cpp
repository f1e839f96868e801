// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/radiance_cache.h"

#include <algorithm>
#include <numeric>

namespace vrc {
namespace {

constexpr std::uint32_t kLeafSize = 4;

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
  p.inverse_deviation = static_cast<float>(1.0 / std::max(1.0 - r.cos_max_deviation, 1e-12));
  p.reach = std::max(p.radius1, p.radius2);
  p.region = record.site.point.region;
  // Derivatives per unit of (a, b), the offsets divided by the radii: they have radiance's unit.
  const auto in_frame = [&](const Vec3& axis, double radius) -> Vec2 {
    return Vec2(axis.dot(record.site.frame.tangent), axis.dot(record.site.frame.bitangent)) * radius;
  };
  const Vec2 a = in_frame(r.axis1, r.radius1), b = in_frame(r.axis2, r.radius2);
  for (std::size_t c = 0; c < 3; ++c) {
    const Jet2& jet = record.radiance[c];
    p.value[c] = static_cast<float>(jet.value);
    p.g1[c] = static_cast<float>(jet.gradient.dot(a));
    p.g2[c] = static_cast<float>(jet.gradient.dot(b));
    p.h11[c] = static_cast<float>(a.dot(jet.hessian * a));
    p.h12[c] = static_cast<float>(a.dot(jet.hessian * b));
    p.h22[c] = static_cast<float>(b.dot(jet.hessian * b));
  }
  return p;
}

/// Bounding box of an ellipsoid with the given half axes.
Eigen::AlignedBox3f bounds(const ValidRegion& r, double support) {
  const Vec3 half =
      support * ((r.axis1 * r.radius1).array().square() + (r.axis2 * r.radius2).array().square() +
                 (r.normal * r.normal_radius).array().square())
                    .sqrt()
                    .matrix();
  return {(r.center - half).cast<float>(), (r.center + half).cast<float>()};
}

}  // namespace

Coverage16 coverage(const PackedRecord& record, const V3x16& x, const V3x16& n, I16 region, float support) {
  const V3x16 d = x - splat3(record.center);
  Coverage16 c;
  c.a = dot(d, splat3(record.scaled1));
  c.b = dot(d, splat3(record.scaled2));
  const F16 along_normal = dot(d, splat3(record.scaled_normal));
  const F16 kr = dot(n, splat3(record.normal));
  const F16 kt2 = (c.a * c.a + c.b * c.b + along_normal * along_normal) * (1.0f / (support * support));
  const F16 k = sqrt(kt2 + max(1.0f - kr, 0.0f) * record.inverse_deviation);
  const F16 kr2 = kr * kr, kr4 = kr2 * kr2, kr8 = kr4 * kr4;
  const I16 applies = (region == record.region) & (kr >= record.cos_max_deviation);
  c.weight = select(applies, max(1.0f - k * kr, 0.0f) * (kr8 * kr8), F16{});
  return c;
}

V3x16 extrapolate(const PackedRecord& record, const Coverage16& c, int order) {
  const F16 aa = 0.5f * c.a * c.a, ab = c.a * c.b, bb = 0.5f * c.b * c.b;
  const auto channel = [&](int i) {
    F16 v = splat(record.value[i]);
    if (order >= 1) v += c.a * record.g1[i] + c.b * record.g2[i];
    if (order >= 2) v += aa * record.h11[i] + ab * record.h12[i] + bb * record.h22[i];
    return max(v, 0.0f);
  };
  return {channel(0), channel(1), channel(2)};
}

RadianceCache::RadianceCache(std::vector<RadianceRecord> records, double max_support)
    : records_(std::move(records)) {
  packed_.reserve(records_.size());
  std::vector<Eigen::AlignedBox3f> boxes;
  for (const RadianceRecord& record : records_) {
    packed_.push_back(pack(record));
    boxes.push_back(bounds(record.region, max_support / record.region.cos_max_deviation));
  }
  order_.resize(records_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()), boxes);
}

std::uint32_t RadianceCache::build(std::uint32_t begin, std::uint32_t end,
                                   const std::vector<Eigen::AlignedBox3f>& boxes) {
  Eigen::AlignedBox3f box, centers;
  for (std::uint32_t i = begin; i < end; ++i) {
    box.extend(boxes[order_[i]]);
    centers.extend(boxes[order_[i]].center());
  }
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({box, begin, end - begin, 0});
  if (end - begin <= kLeafSize) return node;
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::uint32_t middle = (begin + end) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float ca = boxes[a].center()[axis], cb = boxes[b].center()[axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  nodes_[node].count = 0;
  build(begin, middle, boxes);
  const std::uint32_t right = build(middle, end, boxes);
  nodes_[node].right = right;
  return node;
}

void RadianceCache::find(const Box3& box, std::vector<std::uint32_t>& result) const {
  if (nodes_.empty()) return;
  const Eigen::AlignedBox3f query = box.cast<float>();
  const std::size_t first = result.size();
  std::uint32_t stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!node.box.intersects(query)) continue;
    if (node.count > 0) {
      result.insert(result.end(), order_.begin() + node.begin, order_.begin() + node.begin + node.count);
    } else {
      stack[depth++] = node.right;
      stack[depth++] = index + 1;
    }
  }
  std::sort(result.begin() + static_cast<std::ptrdiff_t>(first), result.end());
}

}  // namespace vrc
