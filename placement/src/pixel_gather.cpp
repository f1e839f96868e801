// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/pixel_gather.h"

#include "core/hash.h"
#include "core/parallel.h"
#include "gather_rays.h"

namespace vrc {
namespace {

constexpr double kSimilarNormal = 0.99;                 // least cosine of normals that share a guide
constexpr double kSharedPixels = 8.0;                   // greatest distance over which it is shared
constexpr int kLatticeStep = 12;                        // pixels between guides where there are no records
constexpr int kLog2FirstRays = 12, kLog2MoreRays = 11;  // of the coarser lattice, and of those that it guides

/// What a packet's hits send to the camera.
V3x16 reflected(const GatherRays& rays, const GatherPacket16& packet) {
  return f_cos(rays.bsdf(), rays.directions_at_record(packet)) * packet.inverse_density *
         packet.incident.value;
}

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

const GuideWarp* PixelGatherer::warp_for(const RecordSite& site, Surfaces& surfaces) const {
  const SurfacePoint& p = site.point;
  for (const Surfaces::Kind& kind : surfaces.kinds_) {
    if (kind.material == p.material && kind.normal.dot(p.normal) >= kSimilarNormal &&
        (kind.position - p.position).norm() <= kSharedPixels * site.pixel_length)
      return kind.warp.get();
  }
  surfaces.kinds_.push_back({p.material, p.position, p.normal, guides_.warp_at(site)});
  return surfaces.kinds_.back().warp.get();
}

/// The packets of one Sobol net go to the points by turns, from a random one on: every point has an unbiased
/// share of the net.
std::array<double, 3> PixelGatherer::gather(std::span<const SurfacePoint16> points, int log2_rays,
                                            std::uint64_t key, Surfaces& surfaces, RayCounts& counts) const {
  GatherOptions options;
  options.log2_rays = log2_rays;
  options.bounces = bounces_;
  options.glossy_glossy = options.total_derivative = false;
  options.choose_light = true;
  options.seed = seed_;
  struct Lane {
    const SurfacePoint16* packet;
    int lane;
  };
  std::vector<Lane> lanes;
  for (const SurfacePoint16& packet : points) {
    for (int lane = 0; lane < kLanes; ++lane) {
      if (packet.scatters[lane] != 0) lanes.push_back({&packet, lane});
    }
  }
  if (lanes.empty()) return {};
  static thread_local SobolGrid grid;  // storage only: filled anew for every gather
  fill_sobol_grid(grid, log2_rays, hash(seed_, key));
  const std::size_t first = hash(seed_, key, 0x51deu) % lanes.size();
  std::vector<GatherRays> rays;
  const std::size_t used = std::min(lanes.size(), grid.size() / kLanes);
  rays.reserve(used);
  for (std::size_t i = 0; i < used; ++i) {
    const std::size_t at = (first + i) % lanes.size();
    const auto& [packet, lane] = lanes[at];
    const RecordSite site =
        make_site(scene_,
                  scene_.surface_point(static_cast<std::uint32_t>(packet->triangle[lane]), packet->u[lane],
                                       packet->v[lane], scene_.camera().origin),
                  hash(key, at));
    rays.emplace_back(scene_, site, options, counts, warp_for(site, surfaces));
  }
  V3x16 sum{};
  for (std::size_t i = 0; i < grid.size(); i += kLanes) {
    const auto [u] = grid.packet(i);
    GatherRays& turn = rays[i / kLanes % used];
    GatherPacket16 packet;
    const F16 density = turn.choose_direction(u[0], u[1], packet);
    if (turn.trace(density, u[2], u[3], static_cast<std::uint32_t>(i), packet))
      sum += reflected(turn, packet);
  }
  const double scale = static_cast<double>(lanes.size()) / static_cast<double>(grid.size());
  return {scale * lane_total(sum.x), scale * lane_total(sum.y), scale * lane_total(sum.z)};
}

}  // namespace vrc
