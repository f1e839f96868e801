// SPDX-License-Identifier: GPL-3.0-or-later
#include "packet_response.h"

#include <array>

#include "core/error.h"

namespace vrc {
namespace {

// Angle over which directions share a response, times the order.
constexpr float kSharedAngle = 0.5f;

Vec3 mean_of(const V3x16& v, I16 mask) {
  const auto masked = [&](F16 f) { return static_cast<double>(lane_sum(select(mask, f, F16{}))); };
  return Vec3(masked(v.x), masked(v.y), masked(v.z)).normalized();
}

/// Lanes of `v` within the angle whose cosine is given of lane `lane`.
I16 near_lane(const V3x16& v, int lane, float cosine) {
  return v.x * v.x[lane] + v.y * v.y[lane] + v.z * v.z[lane] >= cosine;
}

}  // namespace

std::span<const PacketResponse::Group> PacketResponse::groups() {
  if (groups_.empty()) compute();
  return groups_;
}

void PacketResponse::compute() {
  VRC_CHECK(brdfs_ != nullptr, "records of spherical harmonics without BRDFs");
  static thread_local std::array<Group, kLanes> storage;  // only one packet is shaded at a time
  std::size_t count = 0;
  for (I16 left = points_.scatters; any(left); ++count) {
    const int lane = first_lane(left);
    const BrdfHarmonics& brdf = brdfs_->of(static_cast<std::size_t>(points_.material[lane]));
    const float angle = kSharedAngle / static_cast<float>(brdf.order() + 1);
    const float cosine = 1.0f - 0.5f * angle * angle;
    Group& group = storage[count];
    group.lanes = left & (points_.material == points_.material[lane]) &
                  near_lane(points_.normal, lane, cosine) & near_lane(to_viewer_, lane, cosine);
    group.lanes[lane] = -1;  // whatever its own cosine is rounded to
    group.weights.resize(brdf.count(), 3);
    brdf.response(mean_of(points_.normal, group.lanes), mean_of(to_viewer_, group.lanes), group.weights);
    left &= ~group.lanes;
  }
  groups_ = std::span(storage).first(count);
}

}  // namespace vrc
