// SPDX-License-Identifier: GPL-3.0-or-later
#include "packet_response.h"

#include <vector>

#include "core/error.h"

namespace vrc {
namespace {

// Angle over which directions share a response, times the order.
constexpr float kSharedAngle = 0.25f;

Vec3 mean_of(const V3x16& v, I16 mask) {
  const auto masked = [&](F16 f) { return static_cast<double>(lane_sum(select(mask, f, F16{}))); };
  return Vec3(masked(v.x), masked(v.y), masked(v.z)).normalized();
}

/// Lanes of `v` within the angle whose cosine is given of lane `lane`.
I16 near_lane(const V3x16& v, int lane, float cosine) {
  return v.x * v.x[lane] + v.y * v.y[lane] + v.z * v.z[lane] >= cosine;
}

}  // namespace

std::span<const V3x16> PacketResponse::weights() {
  if (weights_.empty()) compute();
  return weights_;
}

void PacketResponse::compute() {
  VRC_CHECK(brdfs_ != nullptr, "records of spherical harmonics without BRDFs");
  static thread_local std::vector<V3x16> storage;  // only one packet is shaded at a time
  static thread_local Eigen::MatrixXf response;
  const auto count = static_cast<std::size_t>(sh::coefficient_count(brdfs_->order()));
  storage.assign(count, V3x16{});
  response.resize(static_cast<Eigen::Index>(count), 3);
  const float angle = kSharedAngle / static_cast<float>(brdfs_->order() + 1);
  const float cosine = 1.0f - 0.5f * angle * angle;
  for (I16 left = points_.scatters; any(left);) {
    const int lane = first_lane(left);
    const I16 group = left & (points_.material == points_.material[lane]) &
                      near_lane(points_.normal, lane, cosine) & near_lane(to_viewer_, lane, cosine);
    brdfs_->of(static_cast<std::size_t>(points_.material[lane]))
        .response(mean_of(points_.normal, group), mean_of(to_viewer_, group), response);
    for (std::size_t j = 0; j < count; ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      storage[j].x = select(group, splat(response(row, 0)), storage[j].x);
      storage[j].y = select(group, splat(response(row, 1)), storage[j].y);
      storage[j].z = select(group, splat(response(row, 2)), storage[j].z);
    }
    left &= ~group;
  }
  weights_ = storage;
}

}  // namespace vrc
