// SPDX-License-Identifier: GPL-3.0-or-later
#include "tile_trials.h"

#include <algorithm>
#include <atomic>

#include "core/hash.h"
#include "core/parallel.h"

namespace vrc {
namespace {

constexpr double kDisagreeing = 0.03;  // hard pixels without edges, of all, before it is known
// One tile of so many is tried; fewer, but some, if they take more than a share of the picture's time.
constexpr std::size_t kTriedTile = 5, kFewestTriedTiles = 8;
constexpr double kMostForTrial = 0.02;

}  // namespace

TileTrials::TileTrials(const Scene& scene, const FilmSampler& film, const TileShader& shader,
                       const Layers& layers, const TileLayout& layout, const RenderOptions& options,
                       RecordPlacer& placer, const RunControl& control)
    : scene_(scene),
      film_(film),
      shader_(shader),
      layers_(layers),
      layout_(layout),
      options_(options),
      placer_(placer),
      control_(control),
      image_(scene.camera().width, scene.camera().height, layers.names),
      facts_(facts_count(scene.camera())) {
  for (std::size_t i = 0; i < layout.count(); i += kTriedTile) tiles_.push_back(i);
  std::ranges::sort(tiles_, {}, [](std::size_t i) { return hash(0x71eu, i); });
}

double TileTrials::seconds_with(ShadingEffort effort) {
  if (!options_.shade) return 0.0;
  if (!cache_) {
    PlacementResult placed = placer_.snapshot();
    mean_luminance_ = placed.scale.mean_luminance;
    cache_ = cache_of(std::move(placed));
  }
  effort_ = effort;
  seconds_ = shade(false);
  return seconds_;
}

WorkBesideShading TileTrials::beside() {
  WorkBesideShading work;
  if (!options_.shade) return work;
  if (placer_.open_share() > 0.0) work.path_seconds = std::max(shade(true) - seconds_, 0.0);
  if (options_.cache.hard_pixels) {
    const auto edges = static_cast<double>(std::ranges::count_if(facts_, &PixelFacts::sees_edge));
    work.hard_pixels = all_per_tried_ * edges + kDisagreeing * static_cast<double>(facts_.size());
    const HardPixels hard(scene_, film_, *cache_, facts_, image_, layers_.indirect,
                          {.error = options_.cache.error,
                           .mean_luminance = mean_luminance_,
                           .further_edge_samples = shader_.further_edge_samples(effort_),
                           .bounces = options_.bounces,
                           .seed = options_.seed});
    work.seconds_per_ray = hard.seconds_per_ray(layout_, control_);
  }
  return work;
}

double TileTrials::shade(bool paths_where_open) {
  const LightSources sources = {&*cache_, nullptr, effort_, paths_where_open};
  std::vector<RayCounts> counts(tiles_.size());
  std::atomic<std::size_t> shaded = 0;
  const PhaseTimer timer("shading");
  parallel_for(tiles_.size(), [&](std::size_t i) {
    clear(tiles_[i]);
    if (shaded >= kFewestTriedTiles && timer.elapsed().seconds > kMostForTrial * options_.seconds) return;
    shader_.shade(pixels_of(layout_, tiles_[i]), sources, image_, facts_, counts[i]);
    ++shaded;
  });
  all_per_tried_ = static_cast<double>(layout_.count()) / static_cast<double>(shaded);
  return all_per_tried_ * timer.elapsed().seconds;
}

void TileTrials::clear(std::size_t tile) {
  for (const Pixel& p : pixels_of(layout_, tile)) {
    std::fill_n(image_.pixel(p.x, p.y), layers_.names.size(), 0.0f);
    facts_[facts_index(scene_.camera(), p)] = {};
  }
}

}  // namespace vrc
