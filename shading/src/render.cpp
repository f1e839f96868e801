// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/render.h"

#include <algorithm>
#include <bit>

#include "core/hash.h"
#include "core/parallel.h"
#include "hard_pixels.h"
#include "pixel_facts.h"
#include "placement/pixel_gather.h"
#include "placement/place_records.h"
#include "reported_loop.h"
#include "shading/interpolate.h"
#include "time_budget.h"

namespace vrc {
namespace {

constexpr double kDisagreeing = 0.03;   // hard pixels without edges, of all, before it is known
constexpr std::size_t kTimedTile = 16;  // one of so many tells the time for shading

constexpr int kDirectSamplesWithCache = 4;  // light samples per camera sample where the rest has no noise

/// Channel offsets of the result's image.
struct Layers {
  int direct = 3, indirect = 6, error = -1, albedo = -1, normal = -1, depth = -1;
  std::vector<std::string> names = {"R",        "G",          "B",          "direct.R",  "direct.G",
                                    "direct.B", "indirect.R", "indirect.G", "indirect.B"};

  Layers(bool errors, bool aovs) {
    if (errors) {
      error = static_cast<int>(names.size());
      names.push_back("error.Y");
    }
    if (!aovs) return;
    albedo = static_cast<int>(names.size());
    normal = albedo + 3;
    depth = normal + 3;
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
        layers_(options.method == Method::kCache, options.aovs),
        film_(scene.camera(), scene.film(), options.samples_per_pixel, options.seed),
        samples_at_edges_(options.samples_per_pixel + further_edge_samples(options.samples_per_pixel)),
        facts_(static_cast<std::size_t>(scene.camera().width) *
               static_cast<std::size_t>(scene.camera().height)) {
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
    if (options_.shade && cache_ && options_.cache.hard_pixels) refine(result);
    compose(result.image);
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
    for_each_reported(layout_.count(), "render", control_, [&](std::size_t i) {
      shade_tile(i, cache_ ? &*cache_ : nullptr, result.image, facts_, counts[i]);
    });
    result.stats.phases.push_back(timer.elapsed());
    for (const RayCounts& c : counts) counts_ += c;
  }

  [[nodiscard]] HardPixelOptions hard_pixel_options(double mean_luminance, double seconds) const {
    return {accepted_error_, mean_luminance, seconds, supersamples_edges(), options_.bounces, options_.seed};
  }

  void refine(RenderResult& result) {
    PhaseTimer timer("hard pixels");
    const double seconds =
        options_.seconds > 0.0 ? std::max(options_.seconds - clock_.elapsed().seconds, 1e-3) : 0.0;
    HardPixels hard(scene_, film_, *cache_, facts_, result.image, layers_.indirect,
                    hard_pixel_options(result.scale.mean_luminance, seconds));
    hard.refine(layout_, control_, counts_);
    result.stats.hard_pixels = hard.count();
    result.stats.relative_error = hard.relative_error();
    result.stats.phases.push_back(timer.elapsed());
  }

  void place(RenderResult& result) {
    const PlacementView view = {layout_.x0, layout_.y0, layout_.x1, layout_.y1, &film_};
    RecordPlacer placer(scene_, view, options_.cache, options_.bounces, options_.seed, control_, earlier_);
    accepted_error_ = options_.cache.error;
    if (options_.seconds > 0.0) {
      accepted_error_ = cover_within_time(placer, options_.seconds, clock_, control_,
                                          [&] { return measure_shading(placer); });
    } else {
      placer.cover(accepted_error_);
    }
    if (options_.cache.records == 0) result.stats.error = accepted_error_;
    PlacementResult placed = placer.finish();
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

  [[nodiscard]] bool supersamples_edges() const {
    return options_.method == Method::kCache && options_.cache.supersample_edges;
  }
  [[nodiscard]] std::size_t index_of(const Pixel& p) const {
    return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(scene_.camera().width) +
           static_cast<std::size_t>(p.x);
  }

  /// About, from some tiles.
  WorkAfterRecords measure_shading(const RecordPlacer& placer) const {
    if (!options_.shade) return {};
    PlacementResult placed = placer.snapshot();
    const RadianceCache cache(std::move(placed.charts), std::move(placed.records), placed.reaches,
                              std::move(placed.brdfs));
    const std::size_t tiles = (layout_.count() + kTimedTile - 1) / kTimedTile;
    std::vector<RayCounts> counts(tiles);
    Image image(scene_.camera().width, scene_.camera().height, layers_.names);
    std::vector<PixelFacts> facts(facts_.size());
    const PhaseTimer timer("shading");
    parallel_for(tiles, [&](std::size_t i) { shade_tile(i * kTimedTile, &cache, image, facts, counts[i]); });
    const double scale = static_cast<double>(layout_.count()) / static_cast<double>(tiles);
    WorkAfterRecords work;
    work.shading_seconds = scale * timer.elapsed().seconds;
    if (options_.cache.hard_pixels) {
      const auto edges = std::ranges::count_if(facts, &PixelFacts::sees_edge);
      work.hard_pixels =
          scale * static_cast<double>(edges) + kDisagreeing * static_cast<double>(facts.size());
      const HardPixels hard(scene_, film_, cache, facts, image, layers_.indirect,
                            hard_pixel_options(placed.scale.mean_luminance, 0.0));
      work.seconds_per_ray = hard.seconds_per_ray(layout_, control_);
    }
    return work;
  }

  void shade_tile(std::size_t index, const RadianceCache* cache, Image& image,
                  std::span<PixelFacts> all_facts, RayCounts& counts) const {
    const std::vector<Pixel> pixels = pixels_of(layout_, index);
    PixelGatherer::Surfaces surfaces;
    const std::vector<Pixel> edges =
        for_each_traced(scene_, film_, pixels, supersamples_edges(), counts, [&](const Tile& tile) {
          std::optional<TileRecords> records;
          if (cache != nullptr) records.emplace(*cache, tile);
          std::size_t packet = 0;
          for (const Pixel& p : tile.pixels) {
            float* pixel = image.pixel(p.x, p.y);
            PixelFacts& facts = all_facts[index_of(p)];
            for (int k = 0; k < tile.packets_per_pixel && !control_.stopped(); ++k, ++packet) {
              shade(tile, packet, records ? &*records : nullptr, pixel, facts, counts);
              facts.samples += static_cast<int>(lane_count(tile.packets[packet].active));
              if (gatherer_) add_gathered(tile, packet, surfaces, pixel, counts);
            }
          }
        });
    for (const Pixel& p : edges) all_facts[index_of(p)].sees_edge = true;
    for (const Pixel& p : pixels) {
      PixelFacts& facts = all_facts[index_of(p)];
      facts.finish();
      finish_pixel(facts.samples, image.pixel(p.x, p.y));
    }
  }

  void shade(const Tile& tile, std::size_t index, const TileRecords* records, float* pixel, PixelFacts& facts,
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
      if (records != nullptr) {
        const Interpolated16 light =
            interpolate(*records, index, options_.cache.taylor_order, options_.cache.blend_support);
        add_to(pixel + layers_.indirect, p.scatters, light.radiance);
        facts.add(p, light);
      }
    }
    if (options_.aovs) add_aovs(packet, p, pixel);
  }

  /// Guided rays from a packet's points instead of the rest of its paths.
  void add_gathered(const Tile& tile, std::size_t index, PixelGatherer::Surfaces& surfaces, float* pixel,
                    RayCounts& counts) const {
    const CameraPacket& packet = tile.packets[index];
    const int rays = std::max(options_.path_rays / film_.packets_per_pixel(), 1 << kFewestLog2PixelRays);
    const std::array<double, 3> radiance =
        gatherer_->gather({&tile.points[index], 1}, std::bit_width(static_cast<unsigned>(rays - 1)),
                          hash(packet.pixel_seed[0], packet.sample_index[0]), surfaces, counts);
    for (int c = 0; c < 3; ++c)
      pixel[layers_.indirect + c] += static_cast<float>(radiance[static_cast<std::size_t>(c)]);
  }

  /// Repetition `i` of a sample continues the pixel's sequence.
  [[nodiscard]] PathSampler16 sampler(const CameraPacket& packet, int i) const {
    const auto offset = static_cast<std::uint32_t>(i * samples_at_edges_);
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

  void finish_pixel(int samples, float* pixel) const {
    const float scale = 1.0f / static_cast<float>(std::max(samples, 1));
    for (std::size_t c = 3; c < layers_.names.size(); ++c) pixel[c] *= scale;
  }

  /// R, G, B from the wanted layers, and the layer `error`.
  void compose(Image& image) const {
    for (int y = layout_.y0; y < layout_.y1; ++y) {
      for (int x = layout_.x0; x < layout_.x1; ++x) {
        float* pixel = image.pixel(x, y);
        if (layers_.error >= 0) pixel[layers_.error] = std::sqrt(facts_[index_of({x, y})].total_error());
        for (int c = 0; c < 3; ++c) {
          pixel[c] = (wants_direct_ ? pixel[layers_.direct + c] : 0.0f) +
                     (wants_indirect_ ? pixel[layers_.indirect + c] : 0.0f);
        }
      }
    }
  }

  const Scene& scene_;
  const RenderOptions& options_;
  const RunControl& control_;
  const EarlierFrames& earlier_;
  Layers layers_;
  FilmSampler film_;
  int samples_at_edges_;  // at most
  TileLayout layout_;
  bool wants_direct_ = true, wants_indirect_ = true;
  int light_samples_ = 1;
  std::optional<RadianceCache> cache_;
  std::vector<PixelFacts> facts_;  // of all pixels of the film
  std::optional<GuideField> guides_;
  std::optional<PixelGatherer> gatherer_;  // of guided paths
  double accepted_error_ = 0.0;
  RayCounts counts_;
  PhaseTimer clock_{"render"};
};

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options, const RunControl& control,
                    const EarlierFrames& earlier) {
  return Renderer(scene, options, control, earlier).run();
}

}  // namespace vrc
