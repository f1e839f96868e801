// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/gather.h"

#include <algorithm>

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

Mat2 matrix(double a11, double a12, double a21, double a22) {
  Mat2 m;
  m << a11, a12, a21, a22;
  return m;
}

/// Of sums over rays.
class Means {
 public:
  explicit Means(const GatherRays& rays) : rays_(rays.ray_count()) {}

  [[nodiscard]] double channel(const V3x16& v, std::size_t c) const {
    return lane_total(c == 0 ? v.x : c == 1 ? v.y : v.z) / rays_;
  }
  [[nodiscard]] double variance(const V3x16& v) const { return batch_variance(luminance(v), rays_); }

  [[nodiscard]] RadianceEstimate estimate(const V3x16& value, const UnitJet<V3x16>& j) const {
    const auto jet = [&](const auto& mean) {
      const double h12 = mean(j.h12);
      return Jet2{mean(value), {mean(j.g1), mean(j.g2)}, matrix(mean(j.h11), h12, h12, mean(j.h22))};
    };
    RadianceEstimate result;
    for (std::size_t c = 0; c < 3; ++c)
      result.radiance[c] = jet([&](const V3x16& v) { return channel(v, c); });
    result.luminance = luminance(result.radiance);
    result.variance = jet([&](const V3x16& v) { return variance(v); });
    return result;
  }

 private:
  double rays_;
};

RadianceEstimate mean_of(const RgbJet16& sum, const GatherRays& rays) {
  return Means(rays).estimate(sum.value, sum.jet);
}

RadianceEstimate mean_of(const RgbTiltingJet16& sum, const GatherRays& rays) {
  const Eigen::Matrix2f& s = rays.frame().shape_operator;
  const TiltingJet<V3x16> j = along_surface(sum.jet, s(0, 0), s(0, 1), s(1, 1));
  const Means means(rays);
  RadianceEstimate result = means.estimate(sum.value, j.moved);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto mean = [&](const V3x16& v) { return means.channel(v, c); };
    const double m12 = mean(j.m12);
    result.tilt[c] = {{mean(j.n1), mean(j.n2)},
                      matrix(mean(j.x11), mean(j.x12), mean(j.x21), mean(j.x22)),
                      matrix(mean(j.m11), m12, m12, mean(j.m22))};
  }
  return result;
}

template <template <typename> typename Jet>
RadianceEstimate gather_jets(GatherRays& rays, const GatherOptions& options, GuideHistogram* found) {
  RgbSum16<Jet> sum;
  const auto add_packet = [&](const GatherPacket16& packet) {
    const Directions16 d = rays.directions_at_record(packet);
    // G without the cosine at x, which `shape_jet` holds: s / |r|^4.
    const UnitJet16 geometry = packet.facing * pow(packet.moving.jet_rr, -2.0f);
    for (const Lobe& lobe : rays.bsdf().lobes) {
      std::visit(
          [&](const auto& l) {
            const V3x16 weight = tint(l, d) * (shape(l, d) * packet.inverse_density);
            sum += product(weight, shape_jet<Jet<F16>>(l, packet.moving) * geometry, packet.incident);
          },
          lobe);
    }
    if (found != nullptr) note(packet, *found);
  };
  if (options.occlusion_aware) {
    HitGrid hits((options.log2_rays + 1) / 2, options.log2_rays / 2);
    rays.for_each_packet(add_packet,
                         [&](F16 u1, F16 u2, const GatherPacket16& packet) { hits.store(u1, u2, packet); });
    sum += silhouette_derivatives<Jet>(hits, rays);
  } else {
    rays.for_each_packet(add_packet);
  }
  return mean_of(sum, rays);
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

Vec2 tilt_beyond_shape(const RecordSite& site, const Vec2& d, const Vec3& normal) {
  const Vec2 turned(normal.dot(site.frame.tangent), normal.dot(site.frame.bitangent));
  return turned / std::max(normal.dot(site.frame.normal), static_cast<double>(kLeastTiltCosine)) -
         site.point.shape_operator * d;
}

RadianceEstimate gather_radiance(const Scene& scene, const RecordSite& site, const GatherOptions& options,
                                 RayCounts& counts, const Guidance& guidance) {
  GatherRays rays(scene, site, options, counts, guidance.warp);
  if (guidance.found != nullptr) *guidance.found = {};
  RadianceEstimate result = rays.tilts() ? gather_jets<TiltingJet>(rays, options, guidance.found)
                                         : gather_jets<UnitJet>(rays, options, guidance.found);
  rays.describe_hits(result.hits);
  if (guidance.found != nullptr) {
    const auto scale = static_cast<float>(GuideHistogram::kCells / rays.ray_count());
    for (float& v : guidance.found->mean_square) v *= scale;
  }
  return result;
}

}  // namespace vrc
