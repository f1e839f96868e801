// SPDX-License-Identifier: GPL-3.0-or-later
#include "error_trial.h"

#include <algorithm>
#include <cmath>

#include "core/hash.h"
#include "core/parallel.h"
#include "hard_pixels.h"

namespace vrc {
namespace {

// Pixels that are tried: one of so many, or more of a small picture.
constexpr std::size_t kLargestStride = 16, kFewestTried = 4096;

RenderOptions for_indirect_light(RenderOptions options) {
  options.only = Component::kIndirect;
  options.aovs = false;
  return options;
}

}  // namespace

PixelTrial::PixelTrial(const Scene& scene, const FilmSampler& film, const TileLayout& layout,
                       const RenderOptions& options, RecordPlacer& placer, const RunControl& control)
    : scene_(scene),
      film_(film),
      layout_(layout),
      options_(for_indirect_light(options)),
      placer_(placer),
      control_(control) {
  const auto pixels =
      static_cast<std::size_t>(layout.x1 - layout.x0) * static_cast<std::size_t>(layout.y1 - layout.y0);
  stride_ = std::clamp(pixels / kFewestTried, std::size_t{1}, kLargestStride);
}

std::vector<Pixel> PixelTrial::pixels_of_tile(std::size_t tile) const {
  const std::vector<Pixel> pixels = pixels_of(layout_, tile);
  std::vector<Pixel> result;
  for (std::size_t i = hash(0x7121u, tile) % stride_; i < pixels.size(); i += stride_)
    result.push_back(pixels[i]);
  return result;
}

double PixelTrial::relative_error(double error) {
  const PhaseTimer timer(time_.name);
  PlacementResult placed = placer_.snapshot();
  const double mean_luminance = placed.scale.mean_luminance;
  const RadianceCache cache = cache_of(std::move(placed));
  const Camera& camera = scene_.camera();
  const Layers layers(false, false);
  const TileShader shader(scene_, options_, film_, layers, control_);
  // Samples that no record reaches will get records.
  const LightSources sources = {&cache, nullptr, ShadingEffort::kNoFurtherEdgeSamples, false};

  Image image(camera.width, camera.height, layers.names);
  std::vector<PixelFacts> facts(facts_count(camera));
  struct Sum {
    double error = 0.0, pixels = 0.0;
    RayCounts counts;
  };
  std::vector<Sum> sums(layout_.count());
  parallel_for(layout_.count(), [&](std::size_t i) {
    const std::vector<Pixel> pixels = pixels_of_tile(i);
    if (pixels.empty()) return;
    shader.shade(pixels, sources, image, facts, sums[i].counts);
    for (const Pixel& p : pixels) {
      const PixelFacts& f = facts[facts_index(camera, p)];
      if (f.region < 0) continue;
      const double scale = f.scale(mean_luminance);
      const double squared = static_cast<double>(f.squared_error) / (scale * scale);
      const bool gathered =
          options_.cache.hard_pixels && HardPixels::is_hard(f, static_cast<float>(squared), error);
      sums[i].error += gathered ? error * error : squared;  // hard ones come out about as accepted
      ++sums[i].pixels;
    }
  });
  Sum all;
  for (const Sum& s : sums) {
    all.error += s.error;
    all.pixels += s.pixels;
    counts_ += s.counts;
  }
  const PhaseTime time = timer.elapsed();
  time_.seconds += time.seconds;
  time_.cpu_seconds += time.cpu_seconds;
  return std::sqrt(all.error / std::max(all.pixels, 1.0));
}

}  // namespace vrc
