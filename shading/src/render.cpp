// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/render.h"

#include <cmath>
#include <functional>

#include "error_goal.h"
#include "error_trial.h"
#include "hard_pixels.h"
#include "reported_loop.h"
#include "tile_shader.h"
#include "tile_trials.h"
#include "time_budget.h"

namespace vrc {
namespace {

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
        shader_(scene, options, film_, layers_, control),
        facts_(facts_count(scene.camera())) {
    const Camera& camera = scene.camera();
    const CropWindow window = options.crop.value_or(CropWindow{0, 0, camera.width, camera.height});
    layout_ = {window.x0, window.y0, window.x1, window.y1};
  }

  RenderResult run() {
    RenderResult result;
    result.image = Image(scene_.camera().width, scene_.camera().height, layers_.names);
    if (options_.method == Method::kCache && shader_.wants_indirect()) place(result);
    if (guides_paths()) find_guides(result);
    if (options_.shade) shade_tiles(result);
    if (options_.shade && cache_ && options_.cache.hard_pixels) refine(result);
    compose(result.image);
    result.stats.gather_rays = counts_.gather;
    result.stats.shadow_rays = counts_.shadow;
    result.stats.camera_rays = counts_.camera;
    result.stats.other_rays = counts_.other;
    result.stats.light_samples = shader_.light_samples(timed_.effort);
    result.stats.edge_samples = options_.samples_per_pixel + shader_.further_edge_samples(timed_.effort);
    result.stats.unfinished |= control_.stopped();
    result.cache = std::move(cache_);
    return result;
  }

 private:
  [[nodiscard]] bool guides_paths() const {
    return options_.method == Method::kPath && options_.path_rays > 0 && shader_.wants_indirect();
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
    const LightSources sources = {cache_ ? &*cache_ : nullptr, gatherer_ ? &*gatherer_ : nullptr,
                                  timed_.effort};
    std::vector<RayCounts> counts(layout_.count());
    for_each_reported(layout_.count(), "render", control_, [&](std::size_t i) {
      shader_.shade(pixels_of(layout_, i), sources, result.image, facts_, counts[i]);
    });
    result.stats.phases.push_back(timer.elapsed());
    for (const RayCounts& c : counts) counts_ += c;
  }

  void refine(RenderResult& result) {
    PhaseTimer timer("hard pixels");
    const double seconds =
        options_.seconds > 0.0 ? std::max(options_.seconds - clock_.elapsed().seconds, 1e-3) : 0.0;
    HardPixels hard(scene_, film_, *cache_, facts_, result.image, layers_.indirect,
                    {.error = timed_.error,
                     .mean_luminance = result.scale.mean_luminance,
                     .seconds = seconds,
                     .further_edge_samples = shader_.further_edge_samples(timed_.effort),
                     .bounces = options_.bounces,
                     .seed = options_.seed});
    hard.refine(layout_, control_, counts_);
    result.stats.hard_pixels = hard.count();
    result.stats.relative_error = hard.relative_error();
    result.stats.phases.push_back(timer.elapsed());
  }

  void place(RenderResult& result) {
    const PlacementView view = {layout_.x0, layout_.y0, layout_.x1, layout_.y1, &film_};
    RecordPlacer placer(scene_, view, options_.cache, options_.bounces, options_.seed, control_, earlier_);
    if (options_.cache.records > 0)
      timed_.error = kErrorWithNumber;
    else  // of a fly-through's frames the first decides
      timed_.error = earlier_.cache != nullptr ? earlier_.scale.error : options_.cache.error;
    std::optional<PhaseTime> tried;
    std::function<bool()> enough;
    if (options_.seconds > 0.0) {
      TileTrials trials(scene_, film_, shader_, layers_, layout_, options_, placer, control_);
      timed_ = cover_within_time(placer, options_.seconds, clock_, control_, trials);
      enough = [&] { return clock_.elapsed().seconds > timed_.finish_placing_by; };
    } else if (aims_at_picture()) {
      PixelTrial trial(scene_, film_, layout_, options_, placer, control_);
      timed_.error = cover_within_error(placer, timed_.error, control_, trial);
      tried = trial.time();
      counts_ += trial.counts();
    } else {
      placer.cover(timed_.error);
    }
    if (options_.cache.records == 0) {
      result.stats.records_error = timed_.error;
      if (options_.seconds == 0.0) result.stats.error = options_.cache.error;
    }
    PlacementResult placed = placer.finish(enough);
    counts_ += placed.counts;
    result.stats.phases = std::move(placed.phases);
    if (tried) result.stats.phases.push_back(*tried);
    result.stats.records = placed.records.size();
    result.stats.records_made =
        placed.records.size() - (earlier_.cache != nullptr ? earlier_.cache->records().size() : 0);
    result.scale = placed.scale;
    result.stats.unfinished = placed.unfinished;
    cache_ = cache_of(std::move(placed));
  }

  /// The records' error follows from the picture's.
  [[nodiscard]] bool aims_at_picture() const {
    const CacheOptions& cache = options_.cache;
    return cache.error_of_picture && cache.overture && cache.records == 0 && earlier_.cache == nullptr;
  }

  /// R, G, B from the wanted layers, and the layer `error`.
  void compose(Image& image) const {
    for (int y = layout_.y0; y < layout_.y1; ++y) {
      for (int x = layout_.x0; x < layout_.x1; ++x) {
        float* pixel = image.pixel(x, y);
        if (layers_.error >= 0)
          pixel[layers_.error] = std::sqrt(facts_[facts_index(scene_.camera(), {x, y})].total_error());
        for (int c = 0; c < 3; ++c) {
          pixel[c] = (shader_.wants_direct() ? pixel[layers_.direct + c] : 0.0f) +
                     (shader_.wants_indirect() ? pixel[layers_.indirect + c] : 0.0f);
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
  TileShader shader_;
  TileLayout layout_;
  TimedPlacement timed_;  // without a time: for the error that the options lead to
  std::optional<RadianceCache> cache_;
  std::vector<PixelFacts> facts_;  // of all pixels of the film
  std::optional<GuideField> guides_;
  std::optional<PixelGatherer> gatherer_;  // of guided paths
  RayCounts counts_;
  PhaseTimer clock_{"render"};
};

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options, const RunControl& control,
                    const EarlierFrames& earlier) {
  return Renderer(scene, options, control, earlier).run();
}

}  // namespace vrc
