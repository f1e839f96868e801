// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/gather.h"

#include "gather_rays.h"
#include "silhouettes.h"

namespace vrc {
namespace {

/// Variance of the mean of sixteen batches, of which v / rays are the contributions.
double batch_variance(F16 v, double rays) {
  const double mean = lane_total(v) / kLanes;
  double sum = 0.0;
  for (int i = 0; i < kLanes; ++i) sum += (v[i] - mean) * (v[i] - mean);
  const double scale = kLanes / rays;
  return sum * scale * scale / (kLanes * (kLanes - 1.0));
}

/// Adds the squares of the luminance that arrives along a packet's rays, over their density, to their
/// cells' sums.
void note(const GatherPacket16& packet, GuideHistogram& found) {
  const F16 arriving = select(packet.inverse_density > 0.0f, luminance(packet.incident.value), F16{});
  const F16 square = arriving * arriving / packet.warp_density;
  const I16 cells = guide_cells(packet.u1, packet.u2);
  for (int lane = 0; lane < kLanes; ++lane)
    found.mean_square[static_cast<std::size_t>(cells[lane])] += square[lane];
}

RadianceEstimate mean_of(const RgbJet16& sum, const GatherRays& rays) {
  const double n = rays.ray_count();
  RadianceEstimate result;
  const auto channel = [&](const V3x16& v, int c) {
    return lane_total(c == 0 ? v.x : c == 1 ? v.y : v.z) / n;
  };
  const auto symmetric = [](double a, double b, double c) {
    Mat2 m;
    m << a, b, b, c;
    return m;
  };
  for (int c = 0; c < 3; ++c) {
    Jet2& jet = result.radiance[static_cast<std::size_t>(c)];
    jet.value = channel(sum.value, c);
    jet.gradient = {channel(sum.g1, c), channel(sum.g2, c)};
    jet.hessian = symmetric(channel(sum.h11, c), channel(sum.h12, c), channel(sum.h22, c));
  }
  result.luminance = luminance(result.radiance);
  const auto variance = [&](const V3x16& v) { return batch_variance(luminance(v), n); };
  result.variance.value = variance(sum.value);
  result.variance.gradient = {variance(sum.g1), variance(sum.g2)};
  result.variance.hessian = symmetric(variance(sum.h11), variance(sum.h12), variance(sum.h22));
  rays.describe_hits(result.hits);
  return result;
}

}  // namespace

Jet2 luminance(const std::array<Jet2, 3>& rgb) {
  Jet2 result;
  result.value = luminance(std::array{rgb[0].value, rgb[1].value, rgb[2].value});
  result.gradient =
      kLuminance[0] * rgb[0].gradient + kLuminance[1] * rgb[1].gradient + kLuminance[2] * rgb[2].gradient;
  result.hessian =
      kLuminance[0] * rgb[0].hessian + kLuminance[1] * rgb[1].hessian + kLuminance[2] * rgb[2].hessian;
  return result;
}

RecordSite make_site(const Scene& scene, const SurfacePoint& point, std::uint64_t key) {
  RecordSite site;
  site.point = point;
  site.frame = Frame::around(point.normal);
  site.to_camera = scene.camera().origin - point.position;
  site.pixel_length = scene.camera().pixel_size() * site.to_camera.norm();
  site.key = key;
  return site;
}

Mat2 followed_shape_operator(const RecordSite& site, const GatherOptions& options) {
  return options.total_derivative ? site.point.shape_operator : Mat2::Zero();
}

RadianceEstimate gather_radiance(const Scene& scene, const RecordSite& site, const GatherOptions& options,
                                 RayCounts& counts, const Guidance& guidance) {
  GatherRays rays(scene, site, options, counts, guidance.warp);
  RgbJet16 sum;
  if (guidance.found != nullptr) *guidance.found = {};
  const auto add_packet = [&](const GatherPacket16& packet) {
    const Directions16 d = rays.directions_at_record(packet);
    // G without the cosine at x, which `shape_jet` holds: s / |r|^4.
    const UnitJet16 geometry = packet.facing * pow(packet.moving.jet_rr, -2.0f);
    for (const Lobe& lobe : rays.bsdf().lobes) {
      std::visit(
          [&](const auto& l) {
            const V3x16 weight = tint(l, d) * (shape(l, d) * packet.inverse_density);
            sum.add_product(weight, shape_jet(l, packet.moving) * geometry, packet.incident);
          },
          lobe);
    }
    if (guidance.found != nullptr) note(packet, *guidance.found);
  };
  if (options.occlusion_aware) {
    HitGrid hits((options.log2_rays + 1) / 2, options.log2_rays / 2);
    rays.for_each_packet(add_packet,
                         [&](F16 u1, F16 u2, const GatherPacket16& packet) { hits.store(u1, u2, packet); });
    sum += silhouette_derivatives(hits, rays);
  } else {
    rays.for_each_packet(add_packet);
  }
  if (guidance.found != nullptr) {
    const auto scale = static_cast<float>(GuideHistogram::kCells / rays.ray_count());
    for (float& v : guidance.found->mean_square) v *= scale;
  }
  return mean_of(sum, rays);
}

}  // namespace vrc
