// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/pixel_gather.h"

#include <algorithm>
#include <bit>

#include "core/hash.h"
#include "core/parallel.h"
#include "gather_rays.h"
#include "hit_light.h"
#include "sampling_square.h"
#include "weighted_choice.h"

namespace vrc {
namespace {

// Least cosine of normals that share a guide, on flat surfaces and where they bend.
constexpr double kSimilarNormal = 0.99, kSimilarBentNormal = 0.999;
constexpr double kSharedPixels = 8.0;                   // greatest distance over which it is shared
constexpr int kLatticeStep = 12;                        // pixels between guides where there are no records
constexpr int kLog2FirstRays = 12, kLog2MoreRays = 11;  // of the coarser lattice, and of those that it guides
constexpr float kSameFacet = 0.99f;                     // least cosine of a facet's normals
constexpr float kFlat = 1e-6f;                          // below one, of the cosines of a flat facet's
constexpr std::size_t kViews = 4;                       // points whose BRDFs make a bent facet's guide
constexpr std::size_t kChoices = 16;                    // points that a ray of a bent facet may leave
// Rays of a bent facet that are drawn for all of its points, over those that are drawn at one of them.
constexpr std::size_t kOwnRays = 16;
constexpr float kOwnShare = 1.0f / kOwnRays;

/// The points of a lattice's pixel centres: at multiples of `step` in both directions but not of `without`.
std::vector<RecordSite> lattice_sites(const Scene& scene, const PlacementView& view, int step, int without,
                                      RayCounts& counts) {
  std::vector<RecordSite> sites;
  const Camera& camera = scene.camera();
  for (int y = view.y0; y < view.y1; y += step) {
    for (int x = view.x0; x < view.x1; x += step) {
      if (without > 0 && (x - view.x0) % without == 0 && (y - view.y0) % without == 0) continue;
      I16 first{};
      first[0] = -1;
      const V3x16 direction =
          camera_directions(camera, splat(static_cast<float>(x) + 0.5f), splat(static_cast<float>(y) + 0.5f));
      const SurfacePoint16 p = scene.intersect(first, {splat3(camera.origin), direction, splat(1e17f)},
                                               RayTracer::Coherence::kIncoherent);
      ++counts.camera;
      if (p.scatters[0] == 0) continue;
      const auto triangle = static_cast<std::uint32_t>(p.triangle[0]);
      sites.push_back(make_site(scene, scene.surface_point(triangle, p.u[0], p.v[0], camera.origin),
                                hash(0x1a77u, x, y)));
    }
  }
  return sites;
}

/// A point that a camera sample sees, in all lanes.
struct SeenPoint {
  V3x16 position, normal, geometric_normal, to_camera;

  [[nodiscard]] Directions16 with_camera(const V3x16& direction) const {
    return directions(normal, to_camera, direction);
  }
  [[nodiscard]] I16 sees(const V3x16& direction) const {
    return (dot(direction, normal) > 0.0f) & (dot(direction, geometric_normal) > 0.0f);
  }
};

SeenPoint merged(I16 mask, const SeenPoint& yes, const SeenPoint& no) {
  return {select(mask, yes.position, no.position), select(mask, yes.normal, no.normal),
          select(mask, yes.geometric_normal, no.geometric_normal), select(mask, yes.to_camera, no.to_camera)};
}

Vec3f vector_in(const V3x16& v, int lane) { return {v.x[lane], v.y[lane], v.z[lane]}; }

/// A lane of the points that a pixel's samples see.
struct Lane {
  const SurfacePoint16* packet;
  int lane;

  [[nodiscard]] Vec3f of(const V3x16& v) const { return vector_in(v, lane); }
  [[nodiscard]] Vec3f normal() const { return of(packet->normal); }
  [[nodiscard]] std::int32_t region() const { return packet->region[lane]; }
  [[nodiscard]] std::int32_t material() const { return packet->material[lane]; }
};

/// What a pixel's samples see of one smooth surface, with similar normals.
struct Facet {
  std::vector<Lane> lanes;
  std::vector<SeenPoint> points;  // of the lanes
  RecordSite site;                // where the normal is the most usual one
  bool bends = false;             // its normals differ

  [[nodiscard]] bool takes(const Lane& lane) const {
    const Lane& first = lanes.front();
    return first.region() == lane.region() && first.material() == lane.material() &&
           first.normal().dot(lane.normal()) >= kSameFacet;
  }
};

/// A pixel's facets, and whose turn it is when its points are gone through in the samples' order.
struct Facets {
  struct Turn {
    std::size_t facet, point;
  };
  std::vector<Facet> all;
  std::vector<Turn> turns;

  Facets(const Scene& scene, std::span<const SurfacePoint16> packets) {
    for (const SurfacePoint16& packet : packets) {
      for (int i = 0; i < kLanes; ++i) {
        if (packet.scatters[i] != 0) add({&packet, i});
      }
    }
    for (Facet& f : all) complete(scene, f);
  }

 private:
  void add(const Lane& lane) {
    auto own = std::ranges::find_if(all, [&](const Facet& f) { return f.takes(lane); });
    if (own == all.end()) own = all.emplace(own);
    turns.push_back({static_cast<std::size_t>(own - all.begin()), own->lanes.size()});
    own->lanes.push_back(lane);
  }

  static void complete(const Scene& scene, Facet& f) {
    const Vec3& camera = scene.camera().origin;
    Vec3f mean = Vec3f::Zero();
    for (const Lane& l : f.lanes) {
      const SurfacePoint16& p = *l.packet;
      mean += l.normal();
      f.points.push_back({splat3(l.of(p.position)), splat3(l.normal()), splat3(l.of(p.geometric_normal)),
                          splat3(Vec3((camera - l.of(p.position).cast<double>()).normalized()))});
    }
    mean.normalize();
    const auto turn = [&](const Lane& l) { return 1.0f - l.normal().dot(mean); };
    f.bends = std::ranges::any_of(f.lanes, [&](const Lane& l) { return turn(l) > kFlat; });
    const auto& [packet, i] = *std::ranges::min_element(f.lanes, {}, turn);
    f.site = make_site(scene,
                       scene.surface_point(static_cast<std::uint32_t>(packet->triangle[i]), packet->u[i],
                                           packet->v[i], camera),
                       0);
  }
};

/// Rays that estimate the light of a facet's points together. Where they bend, the BRDFs of all of them
/// make one guide, in directions of space, and each ray leaves one of several points, with probabilities in
/// proportion to what these reflect along it [Talbot2005]: the lobes of a bending surface turn by far more
/// than what lights it. What the middle's square does not see, below its horizon or beside its lobes, is
/// left to few rays from the points' own squares; the balance heuristic weighs both by the densities that
/// they have without a guide [Veach1997].
class FacetRays {
 public:
  FacetRays(const Scene& scene, const Facet& facet, const GuideWarp* warp)
      : scene_(scene),
        facet_(facet),
        square_(square_at(facet.site.frame.normal, facet.site.to_camera.normalized())),
        warp_(warp),
        lift_(static_cast<float>(1e-5 * scene.radius())) {}

  /// What a packet of the facet's net finds, on average over some of the points, from `first` on.
  [[nodiscard]] V3x16 along_middle(std::size_t first, const Sample4& u, std::uint32_t index,
                                   const HitLight& light, RayCounts& counts) const {
    F16 density;
    const V3x16 direction = this->direction(square_, u, density);
    const F16 middle = square_.pdf(square_.with_camera(direction));
    const std::size_t count = facet_.bends ? std::min(facet_.points.size(), kChoices) : 1;
    WeightedChoice16 choice(random_of(u.u[0], u.u[1]));
    V3x16 reflected{};
    SeenPoint from = facet_.points[first];
    for (std::size_t k = 0; k < count; ++k) {
      const SeenPoint& p = facet_.points[(first + k) % facet_.points.size()];
      const Directions16 d = p.with_camera(direction);
      const F16 pdf = facet_.bends ? middle + kOwnShare * square_.pdf(d) : middle;
      const V3x16 f = select(p.sees(direction) & (pdf > 1e-20f),
                             f_cos(square_.bsdf(), d) * (1.0f / max(pdf, 1e-20f)), V3x16{});
      const I16 taken = choice.offer(luminance(f));
      reflected = select(taken, f, reflected);
      from = merged(taken, p, from);
    }
    const I16 active = choice.chosen() > 0.0f;
    if (!any(active)) return V3x16{};
    const F16 scale = choice.total() / (max(choice.chosen(), 1e-30f) * density * static_cast<float>(count));
    return reflected * arriving(active, from, direction, u, index, light, counts) *
           select(active, scale, F16{});
  }

  /// What a packet finds that is drawn in the square of one point of a facet that bends.
  [[nodiscard]] V3x16 along_own(std::size_t point, const Sample4& u, std::uint32_t index,
                                const HitLight& light, RayCounts& counts) const {
    const SeenPoint& p = facet_.points[point];
    const Lane& lane = facet_.lanes[point];
    const SamplingSquare own =
        square_at(lane.normal().cast<double>(), vector_in(p.to_camera, 0).cast<double>());
    F16 density;
    const V3x16 direction = this->direction(own, u, density);
    const Directions16 d = p.with_camera(direction);
    const F16 pdf = square_.pdf(square_.with_camera(direction)) + kOwnShare * own.pdf(d);
    const I16 active = p.sees(direction) & (pdf > 1e-20f);
    if (!any(active)) return V3x16{};
    const V3x16 f = f_cos(own.bsdf(), d) * (kOwnShare / (max(pdf, 1e-20f) * density));
    return select(active, f, V3x16{}) * arriving(active, p, direction, u, index, light, counts);
  }

 private:
  [[nodiscard]] SamplingSquare square_at(const Vec3& normal, const Vec3& to_camera) const {
    const Bsdf& bsdf = scene_.bsdfs()[static_cast<std::size_t>(facet_.site.point.material)];
    return {bsdf, GatherDirections::kMixture, normal, to_camera};
  }

  [[nodiscard]] V3x16 direction(const SamplingSquare& square, const Sample4& u, F16& density) const {
    density = splat(1.0f);
    if (warp_ == nullptr) return square.direction(u.u[0], u.u[1]);
    const GuideWarp::Point16 warped = (*warp_)(u.u[0], u.u[1]);
    density = warped.density;
    return square.direction(warped.u1, warped.u2);
  }

  /// The radiance that arrives.
  [[nodiscard]] V3x16 arriving(I16 active, const SeenPoint& at, const V3x16& direction, const Sample4& u,
                               std::uint32_t index, const HitLight& light, RayCounts& counts) const {
    const V3x16 origin = at.position + at.geometric_normal * lift_ + at.to_camera * (2.0f * lift_);
    const SurfacePoint16 hit =
        scene_.intersect(active, {origin, direction, splat(1e17f)}, RayTracer::Coherence::kCoherent);
    counts.gather += lane_count(active);
    V3x16 sum{};
    if (!any(hit.scatters)) return sum;
    const V3x16 back = -direction;
    light.for_each(hit.scatters, hit, back, u.u[2], u.u[3], index, [&](const ArrivingLight16& a) {
      const Directions16 d = directions(hit.normal, back, a.direction);
      for_each_distinct(a.active, hit.material, [&](I16 mask, std::size_t id) {
        sum += select(mask, f_cos(scene_.bsdfs()[id], d) * a.radiance, V3x16{});
      });
    });
    return sum;
  }

  const Scene& scene_;
  const Facet& facet_;
  SamplingSquare square_;
  const GuideWarp* warp_;
  float lift_;
};

/// Sixteen points of the unit square, one in each of 4 x 4 cells, with two more coordinates.
Sample4 stratified(std::uint64_t seed) {
  Sample4 result;
  for (std::uint32_t d = 0; d < 4; ++d) {
    const auto key = static_cast<std::uint32_t>(hash(seed, d));
    result.u[d] = to_unit_interval(mix32(std::bit_cast<U16>(lane_index()) + key));
  }
  result.u[0] = (to_float(lane_index() & 3) + result.u[0]) * 0.25f;
  result.u[1] = (to_float(lane_index() >> 2) + result.u[1]) * 0.25f;
  return result;
}

}  // namespace

GuideField guides_of_view(const Scene& scene, const PlacementView& view, int bounces, std::uint64_t seed,
                          RayCounts& counts) {
  GuideField guides(scene);
  GatherOptions options;
  options.bounces = bounces;
  options.glossy_glossy = options.total_derivative = options.occlusion_aware = false;
  options.choose_light = true;
  options.seed = hash(seed, 0x9d1eu);
  const auto add = [&](const std::vector<RecordSite>& sites, int log2_rays) {
    options.log2_rays = log2_rays;
    std::vector<std::shared_ptr<const KeptHistogram>> found(sites.size());
    std::vector<RayCounts> rays(sites.size());
    parallel_for(sites.size(), [&](std::size_t i) {
      const std::unique_ptr<const GuideWarp> warp = guides.warp_at(sites[i]);
      GuideHistogram own;
      static_cast<void>(gather_radiance(scene, sites[i], options, rays[i], {warp.get(), &own}));
      found[i] = std::make_shared<const KeptHistogram>(own);
    });
    for (std::size_t i = 0; i < sites.size(); ++i) {
      guides.add(sites[i], std::move(found[i]));
      counts += rays[i];
    }
  };
  add(lattice_sites(scene, view, 2 * kLatticeStep, 0, counts), kLog2FirstRays);
  add(lattice_sites(scene, view, kLatticeStep, 2 * kLatticeStep, counts), kLog2MoreRays);
  return guides;
}

const GuideWarp* PixelGatherer::warp_for(const RecordSite& site, std::span<const Directions16> views,
                                         Surfaces& surfaces) const {
  const SurfacePoint& p = site.point;
  const bool bends = !views.empty();
  for (const Surfaces::Kind& kind : surfaces.kinds_) {
    if (kind.material == p.material && kind.bends == bends &&
        kind.normal.dot(p.normal) >= (bends ? kSimilarBentNormal : kSimilarNormal) &&
        (kind.position - p.position).norm() <= kSharedPixels * site.pixel_length)
      return kind.warp.get();
  }
  surfaces.kinds_.push_back({p.material, bends, p.position, p.normal, guides_.warp_at(site, nullptr, views)});
  return surfaces.kinds_.back().warp.get();
}

/// The packets of one Sobol net go to the points by turns, from a random one on: every point has an unbiased
/// share of the net.
std::array<double, 3> PixelGatherer::gather(std::span<const SurfacePoint16> points, int log2_rays,
                                            std::uint64_t key, Surfaces& surfaces, RayCounts& counts) const {
  const Facets facets(scene_, points);
  if (facets.turns.empty()) return {};
  std::vector<FacetRays> rays;
  rays.reserve(facets.all.size());
  bool bends = false;
  for (const Facet& f : facets.all) {
    std::vector<Directions16> views;
    const std::size_t step = std::max<std::size_t>(f.points.size() / kViews, 1);
    for (std::size_t i = 0; f.bends && i < f.points.size() && views.size() < kViews; i += step)
      views.push_back(f.points[i].with_camera(V3x16{}));
    rays.emplace_back(scene_, f, warp_for(f.site, views, surfaces));
    bends |= f.bends;
  }
  GatherOptions options;
  options.bounces = bounces_;
  options.choose_light = true;
  const HitLight light(scene_, options, static_cast<std::uint32_t>(hash(seed_, key, 0x9a7u)), counts);
  static thread_local SobolGrid grid;  // storage only: filled anew for every gather
  fill_sobol_grid(grid, log2_rays, hash(seed_, key));
  const std::size_t first = hash(seed_, key, 0x51deu) % facets.turns.size();
  const auto turn = [&](std::size_t packet) { return facets.turns[(first + packet) % facets.turns.size()]; };

  V3x16 middle{}, own{};
  for (std::size_t i = 0; i < grid.size(); i += kLanes) {
    const auto [facet, point] = turn(i / kLanes);
    middle += rays[facet].along_middle(point, grid.packet(i), static_cast<std::uint32_t>(i), light, counts);
  }
  const std::size_t own_packets = std::max<std::size_t>(grid.size() / (kLanes * kOwnRays), 1);
  for (std::size_t k = 0; bends && k < own_packets; ++k) {
    const auto [facet, point] = turn(k);
    if (!facets.all[facet].bends) continue;
    own += rays[facet].along_own(point, stratified(hash(seed_, key, 0x0b3u, k)),
                                 static_cast<std::uint32_t>(grid.size() + k * kLanes), light, counts);
  }
  const auto count = static_cast<double>(facets.turns.size());
  const double scale = count / static_cast<double>(grid.size());
  const double own_scale = count / static_cast<double>(own_packets * kLanes);
  const auto total = [&](F16 of_middle, F16 of_own) {
    return scale * lane_total(of_middle) + own_scale * lane_total(of_own);
  };
  return {total(middle.x, own.x), total(middle.y, own.y), total(middle.z, own.z)};
}

}  // namespace vrc
