// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_pixels.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/hash.h"
#include "core/parallel.h"
#include "placement/record_maker.h"
#include "reported_loop.h"

namespace vrc {
namespace {

// Estimated squared error of hard pixels, in squares of the accepted one.
constexpr double kHardError = 8.0;
// Relative variance that one guided ray is taken to have, over four: rays of a half times the square of the
// accepted error.
constexpr double kHalfRays = 0.07;
constexpr int kLog2MostRays = 12;       // of a half
constexpr int kAround = 2;              // pixels of the neighbourhood over which errors are averaged
constexpr float kSimilarNormal = 0.9f;  // cosine of normals that are averaged
// How many pixels of the survey the prior of the calibration counts for, and how far it may go.
constexpr double kPriorPixels = 16.0, kMostCalibration = 4.0;
constexpr double kPriorEdges = 4.0;        // pixels with edges that `accepted` counts for
constexpr std::size_t kFewestAtOnce = 64;  // pixels

int log2_rays_of_half(double error) {
  const double rays = kHalfRays / (error * error);
  return std::clamp(static_cast<int>(std::lround(std::log2(rays))), kFewestLog2PixelRays, kLog2MostRays);
}

GuideField guides_of(const Scene& scene, const RadianceCache& cache) {
  GuideField guides(scene);
  for (const RadianceRecord& record : cache.records()) {
    if (record.found) guides.add(record.site, record.found);
  }
  return guides;
}

}  // namespace

HardPixels::HardPixels(const Scene& scene, const FilmSampler& film, const RadianceCache& cache,
                       std::span<PixelFacts> facts, const HardPixelOptions& options)
    : scene_(scene),
      film_(film),
      facts_(facts),
      options_(options),
      guides_(guides_of(scene, cache)),
      gatherer_(scene, guides_, options.bounces, hash(options.seed, 0x4a2du)),
      sampled_at_(facts.size(), -1) {}

std::size_t HardPixels::index_of(const Pixel& p) const {
  return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(scene_.camera().width) +
         static_cast<std::size_t>(p.x);
}

float HardPixels::scale_of(const PixelFacts& facts) const {
  return static_cast<float>(
      std::max(perceived(static_cast<double>(facts.luminance), options_.mean_luminance), 1e-15));
}

float HardPixels::relative_error_of(const PixelFacts& facts) const {
  const float scale = scale_of(facts);
  return facts.squared_error / (scale * scale);
}

bool HardPixels::is_hard(const PixelFacts& facts) const {
  return facts.sees_edge || relative_error_of(facts) > accepted();
}

float HardPixels::accepted() const {
  return static_cast<float>(kHardError * options_.error * options_.error);
}

double HardPixels::rays_per_pixel(double error) { return std::exp2(1 + log2_rays_of_half(error)); }

std::vector<HardPixels::Sampled> HardPixels::survey(const TileLayout& layout) const {
  std::vector<Sampled> result;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    const std::vector<Pixel> tile = pixels_of(layout, i);
    const Pixel& pixel = tile[hash(options_.seed, 0x50b7e4u, i) % tile.size()];
    const PixelFacts& facts = facts_[index_of(pixel)];
    if (facts.region >= 0) result.push_back({pixel, i, is_hard(facts), {}, 0.0f, 0.0f});
  }
  return result;
}

std::vector<HardPixels::Sampled> HardPixels::candidates(const TileLayout& layout) const {
  std::vector<Sampled> result;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    for (const Pixel& pixel : pixels_of(layout, i)) {
      const PixelFacts& facts = facts_[index_of(pixel)];
      if (facts.region >= 0 && sampled_at_[index_of(pixel)] < 0 && (options_.seconds > 0.0 || is_hard(facts)))
        result.push_back({pixel, i, true, {}, 0.0f, 0.0f});
    }
  }
  if (options_.seconds > 0.0) {
    std::ranges::stable_sort(result, std::greater(),
                             [&](const Sampled& s) { return relative_error_of(facts_[index_of(s.pixel)]); });
  }
  return result;
}

void HardPixels::gather_hard(const TileLayout& layout, const PhaseTimer& timer, const RunControl& control,
                             RayCounts& counts) {
  const std::vector<Sampled> all = candidates(layout);
  if (options_.seconds == 0.0) return gather(all, control, counts);
  // Half of what the time seems to be enough for at a time.
  double spent = timer.elapsed().seconds;
  double cost = spent / static_cast<double>(std::max<std::size_t>(sampled_.size(), 1));
  for (std::size_t next = 0; next < all.size() && !control.stopped();) {
    const double affordable = (options_.seconds - spent) / cost;
    if (affordable < kFewestAtOnce) break;
    const std::size_t count =
        std::min(all.size() - next, std::max(static_cast<std::size_t>(0.5 * affordable), kFewestAtOnce));
    gather({all.begin() + static_cast<std::ptrdiff_t>(next),
            all.begin() + static_cast<std::ptrdiff_t>(next + count)},
           control, counts);
    next += count;
    const double now = timer.elapsed().seconds;
    cost = (now - spent) / static_cast<double>(count);
    spent = now;
  }
}

void HardPixels::gather(std::vector<Sampled> chosen, const RunControl& control, RayCounts& counts) {
  gather_at(chosen, control, counts);
  if (control.stopped()) return;
  for (const Sampled& s : chosen) {
    sampled_at_[index_of(s.pixel)] = static_cast<std::int32_t>(sampled_.size());
    sampled_.push_back(s);
    if (s.hard) ++count_;
  }
}

void HardPixels::gather_at(std::vector<Sampled>& chosen, const RunControl& control, RayCounts& counts) const {
  std::ranges::stable_sort(chosen, {}, &Sampled::tile);
  std::vector<std::span<Sampled>> tiles;
  for (std::size_t begin = 0, end = 0; begin < chosen.size(); begin = end) {
    while (end < chosen.size() && chosen[end].tile == chosen[begin].tile) ++end;
    tiles.push_back(std::span(chosen).subspan(begin, end - begin));
  }
  std::vector<RayCounts> rays(tiles.size());
  for_each_reported(tiles.size(), "hard pixels", control,
                    [&](std::size_t i) { gather_in_tile(tiles[i], rays[i]); });
  for (const RayCounts& c : rays) counts += c;
}

double HardPixels::seconds_per_ray(const TileLayout& layout, const RunControl& control) const {
  std::vector<Sampled> pixels = survey(layout);
  if (pixels.empty()) return 0.0;
  const PhaseTimer timer("survey");
  RayCounts counts;
  gather_at(pixels, control, counts);
  return timer.elapsed().seconds / (static_cast<double>(pixels.size()) * rays_per_pixel(options_.error));
}

void HardPixels::gather_in_tile(std::span<Sampled> chosen, RayCounts& counts) const {
  std::vector<Pixel> pixels;
  for (const Sampled& s : chosen) pixels.push_back(s.pixel);
  std::vector<std::vector<SurfacePoint16>> points(pixels.size());
  for_each_traced(scene_, film_, pixels, options_.supersample_edges, counts, [&](const Tile& tile) {
    std::size_t at = 0;  // the tile holds some of the pixels in their order
    for (std::size_t i = 0; i < tile.pixels.size(); ++i, ++at) {
      while (index_of(pixels[at]) != index_of(tile.pixels[i])) ++at;
      const auto begin = tile.points.begin() + static_cast<std::ptrdiff_t>(i) * tile.packets_per_pixel;
      points[at].insert(points[at].end(), begin, begin + tile.packets_per_pixel);
    }
  });
  const int log2_rays = log2_rays_of_half(options_.error);
  PixelGatherer::Surfaces surfaces;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Sampled& s = chosen[i];
    const PixelFacts& facts = facts_[index_of(s.pixel)];
    float difference[2];
    for (std::size_t half = 0; half < 2; ++half) {
      const std::array<double, 3> sum =
          gatherer_.gather(points[i], log2_rays, hash(s.pixel.x, s.pixel.y, half), surfaces, counts);
      for (int c = 0; c < 3; ++c)
        s.halves[half][c] = static_cast<float>(sum[static_cast<std::size_t>(c)] / facts.samples);
      difference[half] = (luminance(s.halves[half]) - facts.luminance) / scale_of(facts);
    }
    s.bias = difference[0] * difference[1];
    s.noise = 0.25f * (difference[0] - difference[1]) * (difference[0] - difference[1]);
  }
}

/// Scales the estimates of all pixels so that in the survey those without edges are right on average. With an
/// edge they are no lower than the average of such pixels.
void HardPixels::calibrate(const TileLayout& layout) {
  double measured = 0.0, estimated = 0.0, pixels = 0.0;
  double edges = kPriorEdges, edge_error = kPriorEdges * static_cast<double>(accepted());
  for (const Sampled& s : sampled_) {
    if (facts_[index_of(s.pixel)].sees_edge) {
      edge_error += static_cast<double>(s.bias);
      ++edges;
    }
    if (s.hard) continue;
    measured += static_cast<double>(s.bias);
    estimated += static_cast<double>(relative_error_of(facts_[index_of(s.pixel)]));
    ++pixels;
  }
  const auto least = static_cast<float>(std::max(edge_error / edges, 0.0));
  const double prior = pixels > 0.0 ? kPriorPixels * estimated / pixels : 0.0;
  const double factor = estimated > 0.0 ? std::clamp((measured + prior) / (estimated + prior),
                                                     1.0 / kMostCalibration, kMostCalibration)
                                        : 1.0;
  parallel_for(layout.count(), [&](std::size_t i) {
    for (const Pixel& p : pixels_of(layout, i)) {
      PixelFacts& facts = facts_[index_of(p)];
      facts.squared_error *= static_cast<float>(factor);
      const float scale = scale_of(facts);
      if (facts.sees_edge) facts.squared_error = std::max(facts.squared_error, least * scale * scale);
    }
  });
}

/// In the pixels around that were gathered again and show the same surface.
HardPixels::Errors HardPixels::errors_around(const Sampled& s) const {
  const PixelFacts& own = facts_[index_of(s.pixel)];
  const Camera& camera = scene_.camera();
  Errors sum;
  float count = 0.0f;
  for (int y = std::max(s.pixel.y - kAround, 0); y <= std::min(s.pixel.y + kAround, camera.height - 1); ++y) {
    for (int x = std::max(s.pixel.x - kAround, 0); x <= std::min(s.pixel.x + kAround, camera.width - 1);
         ++x) {
      const std::int32_t at = sampled_at_[index_of({x, y})];
      if (at < 0) continue;
      const PixelFacts& other = facts_[index_of({x, y})];
      if (other.region != own.region || other.sees_edge != own.sees_edge ||
          other.normal.dot(own.normal) < kSimilarNormal)
        continue;
      sum.bias += sampled_[static_cast<std::size_t>(at)].bias;
      sum.noise += sampled_[static_cast<std::size_t>(at)].noise;
      ++count;
    }
  }
  // What the records tell counts as one pixel more.
  return {std::max(sum.bias + relative_error_of(own), 0.0f) / (count + 1.0f), sum.noise / count};
}

void HardPixels::blend(Image& image, int first) {
  parallel_for(sampled_.size(), [&](std::size_t i) {
    const Sampled& s = sampled_[i];
    if (!s.hard) return;
    const Errors e = errors_around(s);
    if (!(e.bias > 0.0f)) return;
    const float share = e.bias / (e.bias + e.noise);
    float* pixel = image.pixel(s.pixel.x, s.pixel.y) + first;
    const Rgb mean = 0.5f * (s.halves[0] + s.halves[1]);
    for (int c = 0; c < 3; ++c) pixel[c] += share * (mean[c] - pixel[c]);
    PixelFacts& facts = facts_[index_of(s.pixel)];
    const float scale = scale_of(facts);
    facts.squared_error = share * e.noise * scale * scale;
  });
}

void HardPixels::sum_up(const TileLayout& layout) {
  double sum = 0.0, pixels = 0.0;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    for (const Pixel& p : pixels_of(layout, i)) {
      const PixelFacts& facts = facts_[index_of(p)];
      if (facts.region < 0) continue;
      sum += static_cast<double>(relative_error_of(facts));
      ++pixels;
    }
  }
  relative_error_ = std::sqrt(sum / std::max(pixels, 1.0));
}

void HardPixels::refine(Image& image, int first, const TileLayout& layout, const RunControl& control,
                        RayCounts& counts) {
  const PhaseTimer timer("hard pixels");
  gather(survey(layout), control, counts);
  calibrate(layout);
  gather_hard(layout, timer, control, counts);
  if (control.stopped()) return;
  blend(image, first);
  sum_up(layout);
}

}  // namespace vrc
