// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/render.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <mutex>

#include "core/hash.h"
#include "core/parallel.h"
#include "placement/pixel_gather.h"
#include "placement/place_records.h"
#include "shading/interpolate.h"

namespace vrc {
namespace {

constexpr int kDirectSamplesWithCache = 4;  // light samples per camera sample where the rest has no noise

/// Channel offsets of the result's image.
struct Layers {
  int direct = 3, indirect = 6, albedo = -1, normal = -1, depth = -1;
  std::vector<std::string> names = {"R",        "G",          "B",          "direct.R",  "direct.G",
                                    "direct.B", "indirect.R", "indirect.G", "indirect.B"};

  explicit Layers(bool aovs) {
    if (!aovs) return;
    albedo = 9;
    normal = 12;
    depth = 15;
    names.insert(names.end(), {"albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "depth.Z"});
  }
};

float masked_sum(I16 mask, F16 v) { return lane_sum(select(mask, v, F16{})); }

void add_to(float* pixel, I16 mask, const V3x16& v) {
  pixel[0] += masked_sum(mask, v.x);
  pixel[1] += masked_sum(mask, v.y);
  pixel[2] += masked_sum(mask, v.z);
}

class Renderer {
 public:
  Renderer(const Scene& scene, const RenderOptions& options, const RunControl& control,
           const EarlierFrames& earlier)
      : scene_(scene),
        options_(options),
        control_(control),
        earlier_(earlier),
        layers_(options.aovs),
        film_(scene.camera(), scene.film(), options.samples_per_pixel, options.seed) {
    const Camera& camera = scene.camera();
    const CropWindow window = options.crop.value_or(CropWindow{0, 0, camera.width, camera.height});
    layout_ = {window.x0, window.y0, window.x1, window.y1};
    wants_direct_ = options.only != Component::kIndirect;
    wants_indirect_ =
        options.only != Component::kDirect && options.method != Method::kDirect && options.bounces != 0;
    light_samples_ = options.light_samples > 0          ? options.light_samples
                     : options.method == Method::kCache ? kDirectSamplesWithCache
                                                        : 1;
  }

  RenderResult run() {
    RenderResult result;
    result.image = Image(scene_.camera().width, scene_.camera().height, layers_.names);
    if (options_.method == Method::kCache && wants_indirect_) place(result);
    if (guides_paths()) find_guides(result);
    if (options_.shade) shade_tiles(result);
    result.stats.gather_rays = counts_.gather;
    result.stats.shadow_rays = counts_.shadow;
    result.stats.camera_rays = counts_.camera;
    result.stats.other_rays = counts_.other;
    result.stats.unfinished |= control_.stopped();
    result.cache = std::move(cache_);
    return result;
  }

 private:
  [[nodiscard]] bool guides_paths() const {
    return options_.method == Method::kPath && options_.path_rays > 0 && wants_indirect_;
  }

  void find_guides(RenderResult& result) {
    PhaseTimer timer("find guides");
    const PlacementView view = {layout_.x0, layout_.y0, layout_.x1, layout_.y1, &film_};
    guides_.emplace(guides_of_view(scene_, view, options_.bounces, options_.seed, counts_));
    gatherer_.emplace(scene_, *guides_, options_.bounces, options_.seed);
    result.stats.phases.push_back(timer.elapsed());
  }

  void shade_tiles(RenderResult& result) {
    PhaseTimer timer("render");
    std::vector<RayCounts> counts(layout_.count());
    std::atomic<std::size_t> done{0};
    std::mutex reporting;
    control_.report({"render", 0.0, 0, 0});
    parallel_for(layout_.count(), [&](std::size_t i) {
      if (!control_.stopped()) render_tile(i, result.image, counts[i]);
      done.fetch_add(1);
      if (const std::unique_lock lock(reporting, std::try_to_lock); lock) {
        control_.report(
            {"render", static_cast<double>(done.load()) / static_cast<double>(layout_.count()), 0, 0});
      }
    });
    result.stats.phases.push_back(timer.elapsed());
    for (const RayCounts& c : counts) counts_ += c;
  }

  void place(RenderResult& result) {
    const PlacementView view = {layout_.x0, layout_.y0, layout_.x1, layout_.y1, &film_};
    PlacementResult placed =
        place_records(scene_, view, options_.cache, options_.bounces, options_.seed, control_, earlier_);
    counts_ += placed.counts;
    result.stats.phases = std::move(placed.phases);
    result.stats.records = placed.records.size();
    result.stats.records_made =
        placed.records.size() - (earlier_.cache != nullptr ? earlier_.cache->records().size() : 0);
    result.scale = placed.scale;
    result.stats.unfinished = placed.unfinished;
    cache_.emplace(std::move(placed.charts), std::move(placed.records), placed.reaches,
                   std::move(placed.brdfs));
  }

  void render_tile(std::size_t index, Image& image, RayCounts& counts) const {
    for_each_range(film_, [&](const PacketRange& range) {
      const Tile tile = trace_tile(scene_, film_, layout_, index, range, counts);
      std::optional<TileRecords> records;
      if (cache_) records.emplace(*cache_, tile);
      std::size_t packet = 0;
      for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
          PixelGatherer::Surfaces surfaces;
          for (int k = 0; k < range.count && !control_.stopped(); ++k, ++packet) {
            shade(tile, packet, records ? &*records : nullptr, image.pixel(x, y), counts);
            if (gatherer_) add_gathered(tile, packet, surfaces, image.pixel(x, y), counts);
          }
        }
      }
    });
    const Tile pixels = empty_tile(layout_, index);
    for (int y = pixels.y0; y < pixels.y1; ++y) {
      for (int x = pixels.x0; x < pixels.x1; ++x) finish_pixel(image.pixel(x, y));
    }
  }

  void shade(const Tile& tile, std::size_t index, const TileRecords* records, float* pixel,
             RayCounts& counts) const {
    const CameraPacket& packet = tile.packets[index];
    const SurfacePoint16& p = tile.points[index];
    if (options_.method == Method::kPath) {
      const PathOptions path = {options_.bounces, wants_indirect_ && !gatherer_, wants_direct_};
      for (int i = 0; i < light_samples_ && (path.indirect || path.direct); ++i) {
        const PathRadiance16 radiance =
            trace_paths(scene_, p, packet.direction, packet.active, sampler(packet, i), path, counts);
        add_scaled(pixel, packet.active, radiance);
      }
    } else {
      if (wants_direct_) {
        const PathOptions path = {0, false, true};
        for (int i = 0; i < light_samples_; ++i) {
          add_scaled(
              pixel, packet.active,
              trace_paths(scene_, p, packet.direction, packet.active, sampler(packet, i), path, counts));
        }
      }
      if (records != nullptr)
        add_to(pixel + layers_.indirect, p.scatters,
               interpolate(*records, index, options_.cache.taylor_order, options_.cache.blend_support));
    }
    if (options_.aovs) add_aovs(packet, p, pixel);
  }

  /// Guided rays from a packet's points instead of the rest of its paths.
  void add_gathered(const Tile& tile, std::size_t index, PixelGatherer::Surfaces& surfaces, float* pixel,
                    RayCounts& counts) const {
    const CameraPacket& packet = tile.packets[index];
    const int rays = std::max(options_.path_rays / film_.packets_per_pixel(), 1 << kFewestLog2PixelRays);
    const std::array<double, 3> radiance =
        gatherer_->gather(tile.points[index], std::bit_width(static_cast<unsigned>(rays - 1)),
                          hash(packet.pixel_seed[0], packet.sample_index[0]), surfaces, counts);
    for (int c = 0; c < 3; ++c)
      pixel[layers_.indirect + c] += static_cast<float>(radiance[static_cast<std::size_t>(c)]);
  }

  /// Repetition `i` of a sample continues the pixel's sequence.
  [[nodiscard]] PathSampler16 sampler(const CameraPacket& packet, int i) const {
    const auto offset = static_cast<std::uint32_t>(i * options_.samples_per_pixel);
    return {packet.sample_index + offset, packet.pixel_seed ^ 0x1b56c4e9u};
  }

  void add_scaled(float* pixel, I16 active, const PathRadiance16& radiance) const {
    const float share = 1.0f / static_cast<float>(light_samples_);
    add_to(pixel + layers_.direct, active, radiance.direct * share);
    add_to(pixel + layers_.indirect, active, radiance.indirect * share);
  }

  void add_aovs(const CameraPacket& packet, const SurfacePoint16& p, float* pixel) const {
    for_each_distinct(p.hit, p.material, [&](I16 mask, std::size_t id) {
      add_to(pixel + layers_.albedo, mask, splat3(scene_.bsdfs()[id].albedo()));
    });
    add_to(pixel + layers_.normal, p.hit, p.normal);
    const F16 depth = p.t * dot(packet.direction, splat3(scene_.camera().forward));
    pixel[layers_.depth] += masked_sum(p.hit, depth);
  }

  void finish_pixel(float* pixel) const {
    const float scale = 1.0f / static_cast<float>(options_.samples_per_pixel);
    for (std::size_t c = 3; c < layers_.names.size(); ++c) pixel[c] *= scale;
    for (int c = 0; c < 3; ++c) {
      pixel[c] = (wants_direct_ ? pixel[layers_.direct + c] : 0.0f) +
                 (wants_indirect_ ? pixel[layers_.indirect + c] : 0.0f);
    }
  }

  const Scene& scene_;
  const RenderOptions& options_;
  const RunControl& control_;
  const EarlierFrames& earlier_;
  Layers layers_;
  FilmSampler film_;
  TileLayout layout_;
  bool wants_direct_ = true, wants_indirect_ = true;
  int light_samples_ = 1;
  std::optional<RadianceCache> cache_;
  std::optional<GuideField> guides_;
  std::optional<PixelGatherer> gatherer_;  // of guided paths
  RayCounts counts_;
};

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options, const RunControl& control,
                    const EarlierFrames& earlier) {
  return Renderer(scene, options, control, earlier).run();
}

}  // namespace vrc
