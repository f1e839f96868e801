// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/interpolate.h"

#include "packet_response.h"
#include "placement/place_records.h"

namespace vrc {
namespace {

struct WeightedSum {
  V3x16 radiance{};
  F16 weight{};
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
                          double trusted, PacketResponse& response) {
  WeightedSum sum;
  records.for_each(packet, static_cast<float>(support), [&](const PackedRecord& record, const Coverage16& c) {
    const F16 distance = sqrt(c.a * c.a + c.b * c.b);
    const F16 inward = min(static_cast<float>(trusted) / max(distance, 1e-20f), 1.0f);
    const Coverage16 limited = {c.a * inward, c.b * inward, c.weight};
    const V3x16 value = record.harmonics != nullptr ? from_harmonics(record, limited, order, response)
                                                    : extrapolate(record, limited, order);
    sum.radiance += select(c.weight > 0.0f, value * c.weight, V3x16{});
    sum.weight += c.weight;
  });
  return sum;
}

}  // namespace

V3x16 interpolate(const TileRecords& records, std::size_t packet, int taylor_order, double support) {
  const SurfacePoint16& p = records.tile().points[packet];
  if (!any(p.scatters)) return V3x16{};
  const V3x16 to_viewer = -records.tile().packets[packet].direction;
  PacketResponse response(records.cache().brdfs().get(), p, to_viewer);
  const WeightedSum near = blend_records(records, packet, taylor_order, support, support, response);
  V3x16 result = near.radiance * (1.0f / max(near.weight, 1e-20f));
  const I16 missed = p.scatters & ~(near.weight > 0.0f);
  if (any(missed)) {
    const WeightedSum wide = blend_records(records, packet, taylor_order, kWideSupport, support, response);
    result = select(missed, wide.radiance * (1.0f / max(wide.weight, 1e-20f)), result);
  }
  return result;
}

}  // namespace vrc
