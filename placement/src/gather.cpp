// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/gather.h"

#include <algorithm>
#include <limits>

#include "core/hash.h"
#include "core/sobol.h"
#include "transport/lobe_jets.h"

namespace vrc {
namespace {

/// A scalar with its derivatives per channel, summed over rays; sixteen partial sums.
struct RgbJet16 {
  V3x16 value{}, g1{}, g2{}, h11{}, h12{}, h22{};

  /// Adds c j, j the unit jet of c.
  void add(const V3x16& c, const UnitJet16& j) {
    value += c;
    g1 += c * j.g1;
    g2 += c * j.g2;
    h11 += c * j.h11;
    h12 += c * j.h12;
    h22 += c * j.h22;
  }
  /// Adds the product of c j with a factor that has derivatives per channel.
  void add_product(const V3x16& c, const UnitJet16& j, const RgbJet16& factor) {
    value += c * factor.value;
    g1 += c * (factor.value * j.g1 + factor.g1);
    g2 += c * (factor.value * j.g2 + factor.g2);
    h11 += c * (factor.value * j.h11 + factor.g1 * (2.0f * j.g1) + factor.h11);
    h12 += c * (factor.value * j.h12 + factor.g1 * j.g2 + factor.g2 * j.g1 + factor.h12);
    h22 += c * (factor.value * j.h22 + factor.g2 * (2.0f * j.g2) + factor.h22);
  }
};

/// How the columns of the sample grid are shared out, in eighths: cosine sampling first, then the
/// glossy lobes. Cosine rays carry the diffuse part, lobe rays the highlights; both see everything.
struct Strategy {
  const Lobe* lobe = nullptr;  ///< nullptr: cosine.
  float begin = 0.0f, end = 1.0f;
};

std::vector<Strategy> make_strategies(const Bsdf& bsdf) {
  std::vector<const Lobe*> glossy;
  bool diffuse = false;
  for (const Lobe& lobe : bsdf.lobes) {
    if (std::holds_alternative<LambertLobe>(lobe))
      diffuse = true;
    else
      glossy.push_back(&lobe);
  }
  if (glossy.empty()) return {{}};
  const int count = std::min<int>(static_cast<int>(glossy.size()), 4);
  const int glossy_eighths = std::max(diffuse ? 2 : 4, count);
  std::vector<Strategy> result = {{nullptr, 0.0f, static_cast<float>(8 - glossy_eighths) / 8.0f}};
  for (int i = 0; i < count; ++i) {
    const float begin = result.back().end;
    const int share = (glossy_eighths * (i + 1)) / count - (glossy_eighths * i) / count;
    result.push_back({glossy[static_cast<std::size_t>(i)], begin, begin + static_cast<float>(share) / 8.0f});
  }
  return result;
}

/// One record's gather: what all its rays share.
class Gatherer {
 public:
  Gatherer(const Scene& scene, const RecordSite& site, const GatherOptions& options, RayCounts& counts)
      : scene_(scene),
        options_(options),
        counts_(counts),
        bsdf_(scene.bsdfs()[static_cast<std::size_t>(site.point.material)]),
        strategies_(make_strategies(bsdf_)) {
    frame_.x = site.point.position.cast<float>();
    frame_.tangent = site.frame.tangent.cast<float>();
    frame_.bitangent = site.frame.bitangent.cast<float>();
    frame_.normal = site.frame.normal.cast<float>();
    frame_.to_camera = site.to_camera.cast<float>();
    frame_.shape_operator = site.point.shape_operator.cast<float>();
    normal_ = splat3(frame_.normal);
    geometric_normal_ = splat3(site.point.geometric_normal);
    to_camera_ = splat3(Vec3(site.to_camera.normalized()));
    // Off the surface and towards the camera: in a crease the second keeps the origin in the open.
    const Vec3 lift =
        scene.radius() * (1e-5 * site.point.geometric_normal + 2e-5 * site.to_camera.normalized());
    origin_ = splat3(Vec3(site.point.position + lift));
    path_seed_ = static_cast<std::uint32_t>(hash(options.seed, site.key, 0x9a7u));
  }

  void trace(const F16 (&u)[kSobolDimensions], std::uint32_t first_index) {
    const V3x16 direction = sample_direction(u[0], u[1]);
    const Directions16 d = directions(normal_, to_camera_, direction);
    I16 active = (d.cos_i > 0.0f) & (dot(direction, geometric_normal_) > 0.0f);
    const F16 density = mixture_pdf(d);
    active &= density > 1e-20f;
    const SurfacePoint16 hit =
        scene_.intersect(active, {origin_, direction, splat(1e17f)}, RayTracer::Coherence::kCoherent);
    counts_.gather += lane_count(active);
    note_distances(hit, direction);
    const I16 lit = hit.scatters;
    if (!any(lit)) return;

    const V3x16 r = select(lit, hit.position - splat3(frame_.x), normal_);
    const MovingPoint16 moving = moving_point(frame_, r);
    RgbJet16 incident;
    add_direct_light(lit, hit, direction, moving, u[2], u[3], incident);
    if (options_.bounces != 1) add_bounced_light(lit, hit, direction, moving, first_index, incident);

    // G without the cosine at x: s / |r|^4, s = -n_y . r with the geometric normal at the hit.
    const V3x16 ny = to_frame(hit.geometric_normal);
    const F16 s = max(-dot(hit.geometric_normal, r), 1e-6f * sqrt(moving.rr));
    const UnitJet16 geometry = jet_of_linear(moving, s, -ny.x, -ny.y, -ny.z) * pow(moving.jet_rr, -2.0f);
    const F16 inverse_density = select(lit, 1.0f / density, F16{});
    for (const Lobe& lobe : bsdf_.lobes) {
      std::visit(
          [&](const auto& l) {
            const V3x16 weight = tint(l, d) * (shape(l, d) * inverse_density);
            sum_.add_product(weight, shape_jet(l, moving) * geometry, incident);
          },
          lobe);
    }
  }

  [[nodiscard]] RadianceEstimate finish(std::size_t rays) const;

 private:
  [[nodiscard]] V3x16 to_frame(const V3x16& v) const {
    return {dot(v, splat3(frame_.tangent)), dot(v, splat3(frame_.bitangent)), dot(v, normal_)};
  }

  /// Blocks of sixteen points lie in one strategy's columns.
  [[nodiscard]] V3x16 sample_direction(F16 u1, F16 u2) const {
    const auto strategy = std::ranges::find_if(strategies_, [&](const Strategy& s) { return u1[0] < s.end; });
    const Strategy& s = strategy == strategies_.end() ? strategies_.back() : *strategy;
    const F16 stretched = min(max((u1 - s.begin) * (1.0f / (s.end - s.begin)), 0.0f), 0x1.fffffep-1f);
    if (s.lobe == nullptr) return sample(LambertLobe{}, normal_, to_camera_, stretched, u2);
    return std::visit([&](const auto& l) { return sample(l, normal_, to_camera_, stretched, u2); }, *s.lobe);
  }

  [[nodiscard]] F16 mixture_pdf(const Directions16& d) const {
    F16 sum{};
    for (const Strategy& s : strategies_) {
      const F16 density = s.lobe == nullptr ? pdf(LambertLobe{}, d)
                                            : std::visit([&](const auto& l) { return pdf(l, d); }, *s.lobe);
      sum += (s.end - s.begin) * density;
    }
    return sum;
  }

  void note_distances(const SurfacePoint16& hit, const V3x16& direction) {
    const F16 t = select(hit.hit, hit.t, splat(std::numeric_limits<float>::infinity()));
    inverse_distance_ += select(hit.hit, 1.0f / max(hit.t, 1e-30f), F16{});
    const I16 nearer = t < nearest_;
    nearest_ = select(nearer, t, nearest_);
    nearest_direction_ = select(nearer, direction, nearest_direction_);
    nearest_normal_ = select(nearer, hit.geometric_normal, nearest_normal_);
  }

  /// Adds the radiance that the hits reflect of light from directions m, with its glossy-glossy jet.
  void add_reflection(I16 active, const SurfacePoint16& hit, const V3x16& direction,
                      const MovingPoint16& moving, const V3x16& m, const V3x16& radiance,
                      RgbJet16& incident) const {
    const Directions16 d = directions(hit.normal, -direction, m);
    FixedReflector16 y;
    y.n = to_frame(hit.normal);
    y.light = to_frame(m);
    y.nr = -max(dot(y.n, V3x16{-moving.r1, -moving.r2, -moving.nr}), 1e-20f);
    y.light_cos = d.cos_i;
    y.light_r = y.light.x * moving.r1 + y.light.y * moving.r2 + y.light.z * moving.nr;
    for_each_distinct(active, hit.material, [&](I16 mask, std::size_t id) {
      for (const Lobe& lobe : scene_.bsdfs()[id].lobes) {
        std::visit(
            [&](const auto& l) {
              const V3x16 reflected = select(mask, radiance * tint(l, d) * shape(l, d), V3x16{});
              if (options_.glossy_glossy)
                incident.add(reflected, masked(mask, reflector_jet(l, y, moving)));
              else
                incident.value += reflected;
            },
            lobe);
      }
    });
  }

  static UnitJet16 masked(I16 mask, const UnitJet16& j) {
    const F16 zero{};
    return {select(mask, j.g1, zero), select(mask, j.g2, zero), select(mask, j.h11, zero),
            select(mask, j.h12, zero), select(mask, j.h22, zero)};
  }

  void add_direct_light(I16 active, const SurfacePoint16& hit, const V3x16& direction,
                        const MovingPoint16& moving, F16 u1, F16 u2, RgbJet16& incident) {
    const LightSample16 light = scene_.lights().sample(hit.position, hit.normal, u1, u2);
    const I16 candidate = active & light.valid & (dot(light.direction, hit.geometric_normal) > 0.0f) &
                          (dot(light.direction, hit.normal) > 0.0f);
    if (!any(candidate)) return;
    const I16 blocked =
        scene_.tracer().occluded(candidate, scene_.shadow_ray(hit, light), RayTracer::Coherence::kCoherent);
    counts_.shadow += lane_count(candidate);
    add_reflection(candidate & ~blocked, hit, direction, moving, light.direction, light.radiance, incident);
  }

  void add_bounced_light(I16 active, const SurfacePoint16& hit, const V3x16& direction,
                         const MovingPoint16& moving, std::uint32_t first_index, RgbJet16& incident) {
    const PathSampler16 sampler = {std::bit_cast<U16>(lane_index()) + first_index, splat(path_seed_)};
    const Sample4 u = sampler.vertex(0);
    const V3x16 m = sample_bsdf(scene_.bsdfs(), active, hit.material, hit.normal, -direction, u.u[0], u.u[1]);
    const BsdfValue16 bsdf =
        evaluate_bsdf(scene_.bsdfs(), active, hit.material, directions(hit.normal, -direction, m));
    active &= (dot(m, hit.geometric_normal) > 0.0f) & (bsdf.pdf > 1e-20f);
    if (!any(active)) return;
    const SurfacePoint16 next =
        scene_.intersect(active, {scene_.lifted(hit), m, splat(1e17f)}, RayTracer::Coherence::kIncoherent);
    counts_.other += lane_count(active);
    const PathSampler16 further = {sampler.index, splat(path_seed_ ^ 0x5bd1e995u)};
    const int left = options_.bounces < 0 ? -1 : options_.bounces - 2;
    const V3x16 radiance = reflected_radiance(scene_, next, m, active & next.hit, further, left, counts_);
    add_reflection(active, hit, direction, moving, m, radiance * (1.0f / max(bsdf.pdf, 1e-20f)), incident);
  }

  const Scene& scene_;
  const GatherOptions& options_;
  RayCounts& counts_;
  const Bsdf& bsdf_;
  std::vector<Strategy> strategies_;
  RecordFrame frame_;
  V3x16 normal_, geometric_normal_, to_camera_, origin_;
  std::uint32_t path_seed_ = 0;

  RgbJet16 sum_;
  F16 nearest_ = splat(std::numeric_limits<float>::infinity());
  V3x16 nearest_direction_{}, nearest_normal_{};
  F16 inverse_distance_{};
};

double lane_total(F16 v) {
  double sum = 0.0;
  for (int i = 0; i < kLanes; ++i) sum += v[i];
  return sum;
}

/// Variance of the mean of sixteen batches, of which v / rays are the contributions.
double batch_variance(F16 v, double rays) {
  const double mean = lane_total(v) / kLanes;
  double sum = 0.0;
  for (int i = 0; i < kLanes; ++i) sum += (v[i] - mean) * (v[i] - mean);
  const double scale = kLanes / rays;
  return sum * scale * scale / (kLanes * (kLanes - 1.0));
}

RadianceEstimate Gatherer::finish(std::size_t rays) const {
  const double n = static_cast<double>(rays);
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
    jet.value = channel(sum_.value, c);
    jet.gradient = {channel(sum_.g1, c), channel(sum_.g2, c)};
    jet.hessian = symmetric(channel(sum_.h11, c), channel(sum_.h12, c), channel(sum_.h22, c));
  }
  const auto& rgb = result.radiance;
  result.luminance.value = luminance(std::array{rgb[0].value, rgb[1].value, rgb[2].value});
  result.luminance.gradient =
      0.212671 * rgb[0].gradient + 0.715160 * rgb[1].gradient + 0.072169 * rgb[2].gradient;
  result.luminance.hessian =
      0.212671 * rgb[0].hessian + 0.715160 * rgb[1].hessian + 0.072169 * rgb[2].hessian;
  const auto variance = [&](const V3x16& v) { return batch_variance(luminance(v), n); };
  result.variance.value = variance(sum_.value);
  result.variance.gradient = {variance(sum_.g1), variance(sum_.g2)};
  result.variance.hessian = symmetric(variance(sum_.h11), variance(sum_.h12), variance(sum_.h22));

  int lane = 0;
  for (int i = 1; i < kLanes; ++i) {
    if (nearest_[i] < nearest_[lane]) lane = i;
  }
  result.nearest_hit = nearest_[lane];
  const auto of_lane = [&](const V3x16& v) { return Vec3(v.x[lane], v.y[lane], v.z[lane]); };
  result.nearest_direction = of_lane(nearest_direction_);
  result.nearest_normal = of_lane(nearest_normal_);
  result.mean_inverse_hit = lane_total(inverse_distance_) / n;
  return result;
}

}  // namespace

RecordSite make_site(const Scene& scene, const SurfacePoint& point, std::uint64_t key) {
  RecordSite site;
  site.point = point;
  site.frame = Frame::around(point.normal);
  site.to_camera = scene.camera().origin - point.position;
  site.pixel_length = scene.camera().pixel_size() * site.to_camera.norm();
  site.key = key;
  return site;
}

RadianceEstimate gather_radiance(const Scene& scene, const RecordSite& site, const GatherOptions& options,
                                 RayCounts& counts) {
  static thread_local SobolGrid grid;  // storage only: filled anew for every record
  fill_sobol_grid(grid, options.log2_rays, hash(options.seed, site.key));
  Gatherer gatherer(scene, site, options, counts);
  for (std::size_t i = 0; i < grid.size(); i += kLanes) {
    F16 u[kSobolDimensions];
    for (int d = 0; d < kSobolDimensions; ++d) __builtin_memcpy(&u[d], grid.u[d].data() + i, sizeof(F16));
    gatherer.trace(u, static_cast<std::uint32_t>(i));
  }
  return gatherer.finish(grid.size());
}

}  // namespace vrc
