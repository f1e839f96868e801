// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/interpolate.h"

#include "packet_response.h"
#include "placement/place_records.h"

namespace vrc {
namespace {

// Squared error of a blend over the spread of what was blended, and over the variance that sixteen batches of
// each record's rays tell: measured (docs/decisions/011).
constexpr float kErrorOfSpread = 0.5f, kErrorOfNoise = 0.4f;

/// Of predictions and their weights.
struct WeightedSum {
  V3x16 radiance{};
  F16 weight{};
  F16 luminance{}, luminance2{};
  F16 noise{};  ///< Variances by squared weights.

  void add(const PackedRecord& record, F16 w, const V3x16& value) {
    radiance += select(w > 0.0f, value * w, V3x16{});
    weight += w;
    const F16 y = select(w > 0.0f, vrc::luminance(value), F16{});
    luminance += w * y;
    luminance2 += w * y * y;
    noise += w * w * record.variance;
  }

  [[nodiscard]] Interpolated16 blend() const {
    const F16 scale = 1.0f / max(weight, 1e-20f);
    const F16 mean = luminance * scale;
    const F16 disagreement = max(luminance2 * scale - mean * mean, 0.0f);
    return {radiance * scale, ~(weight > 0.0f),
            kErrorOfSpread * disagreement + kErrorOfNoise * (noise * scale * scale)};
  }
};

V3x16 from_harmonics(const PackedRecord& record, const Coverage16& c, int order, PacketResponse& response) {
  V3x16 result{};
  for (const PacketResponse::Group& group : response.groups()) {
    const I16 wanted = group.lanes & (c.weight > 0.0f);
    if (any(wanted)) result = select(wanted, extrapolate(record, group.weights, c, order), result);
  }
  return result;
}

/// Limited derivatives hold up to `trusted` radii: farther out the value there is taken.
WeightedSum blend_records(const TileRecords& records, std::size_t packet, int order, double support,
                          Deviation deviation, double trusted, PacketResponse& response) {
  WeightedSum sum;
  records.for_each(
      packet, static_cast<float>(support), deviation, [&](const PackedRecord& record, const Coverage16& c) {
        const Coverage16 limited = drawn_in(record, c, static_cast<float>(trusted));
        const V3x16 value = record.harmonics != nullptr ? from_harmonics(record, limited, order, response)
                                                        : extrapolate(record, limited, order);
        sum.add(record, c.weight, value);
      });
  return sum;
}

}  // namespace

Interpolated16 interpolate(const TileRecords& records, std::size_t packet, int taylor_order, double support) {
  const SurfacePoint16& p = records.tile().points[packet];
  if (!any(p.scatters)) return {};
  const V3x16 to_viewer = -records.tile().packets[packet].direction;
  PacketResponse response(records.cache().brdfs().get(), p, to_viewer);
  Interpolated16 result =
      blend_records(records, packet, taylor_order, support, Deviation::kAccepted, support, response).blend();
  result.open &= p.scatters;
  if (const I16 missed = result.open; any(missed)) {
    const Interpolated16 wide =
        blend_records(records, packet, taylor_order, kWideSupport, Deviation::kWidest, support, response)
            .blend();
    result.radiance = select(missed, wide.radiance, result.radiance);
    result.squared_error = select(missed, wide.squared_error, result.squared_error);
    result.open &= wide.open;
  }
  return result;
}

}  // namespace vrc
