// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_pixels.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/hash.h"
#include "core/parallel.h"
#include "reported_loop.h"

namespace vrc {
namespace {

// Estimated squared error of hard pixels, in squares of the accepted one.
constexpr double kHardError = 8.0;
// Relative variance that one guided ray is taken to have, over four: rays of a half times the square of the
// accepted error.
constexpr double kHalfRays = 0.07;
constexpr int kLog2MostRays = 12;  // of a half
// Pixels that stay hard get 2^kLog2Further times the rays once more, up to kFurtherRounds times.
constexpr int kLog2Further = 2, kFurtherRounds = 3;
constexpr int kAround = 4;       // pixels of the neighbourhood that is averaged
constexpr float kSpread = 2.0f;  // deviation of its weights
// Cosine of normals, and ratio of luminances, that are averaged.
constexpr float kSimilarNormal = 0.9f, kSimilarBrightness = 1.5f;
// Deviation of the estimates' ratio to the truth before the survey, and how far the calibration may go.
constexpr double kPriorDeviation = 0.4, kMostCalibration = 4.0;
constexpr double kPriorEdges = 4.0;        // pixels with edges that `accepted` counts for
constexpr std::size_t kFewestAtOnce = 64;  // pixels
constexpr double kMostForSurvey = 0.2;     // of a time that is to be filled
constexpr float kSignificant = 9.0f;       // squared deviations by which a single pixel stands out
constexpr float kUnusualNoise = 16.0f;     // over the usual one around, at which a gather counts half

int log2_rays_of_half(double error) {
  const double rays = kHalfRays / (error * error);
  return std::clamp(static_cast<int>(std::lround(std::log2(rays))), kFewestLog2PixelRays, kLog2MostRays);
}

/// Estimated relative squared error up to which pixels are not hard.
float most_left_alone(double error) { return static_cast<float>(kHardError * error * error); }

/// P / (P + V).
float ratio(float p, float v) { return p > 0.0f ? p / (p + v) : 0.0f; }

GuideField guides_of(const Scene& scene, const RadianceCache& cache) {
  GuideField guides(scene);
  for (const RadianceRecord& record : cache.records()) {
    if (record.found) guides.add(record.site, record.found);
  }
  return guides;
}

}  // namespace

HardPixels::HardPixels(const Scene& scene, const FilmSampler& film, const RadianceCache& cache,
                       std::span<PixelFacts> facts, Image& image, int first, const HardPixelOptions& options)
    : scene_(scene),
      film_(film),
      facts_(facts),
      image_(image),
      first_(first),
      options_(options),
      guides_(guides_of(scene, cache)),
      gatherer_(scene, guides_, options.bounces, hash(options.seed, 0x4a2du)),
      scale_(facts.size()),
      sampled_at_(facts.size(), -1) {
  const auto width = static_cast<std::size_t>(scene.camera().width);
  parallel_for(facts.size() / width, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      scale_[i] = static_cast<float>(facts[i].scale(options.mean_luminance));
    }
  });
}

std::size_t HardPixels::index_of(const Pixel& p) const { return facts_index(scene_.camera(), p); }

float HardPixels::relative_error_of(std::size_t index) const {
  return facts_[index].squared_error / square_scale_of(index);
}

bool HardPixels::is_hard(const PixelFacts& facts, float relative_error, double error) {
  return facts.sees_edge || relative_error > most_left_alone(error);
}

bool HardPixels::is_hard(std::size_t index) const {
  return is_hard(facts_[index], relative_error_of(index), options_.error);
}

float HardPixels::accepted() const { return most_left_alone(options_.error); }

double HardPixels::rays_per_pixel(double error) { return std::exp2(1 + log2_rays_of_half(error)); }

std::vector<HardPixels::Sampled> HardPixels::survey(const TileLayout& layout) const {
  std::vector<Sampled> result;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    const std::vector<Pixel> tile = pixels_of(layout, i);
    const Pixel& pixel = tile[hash(options_.seed, 0x50b7e4u, i) % tile.size()];
    const std::size_t index = index_of(pixel);
    if (facts_[index].region >= 0)
      result.push_back(Sampled{.pixel = pixel, .tile = i, .hard = is_hard(index)});
  }
  std::ranges::stable_sort(result, {}, [&](const Sampled& s) { return hash(options_.seed, s.tile); });
  return result;
}

std::vector<HardPixels::Sampled> HardPixels::candidates(const TileLayout& layout) const {
  struct Candidate {
    bool hard;
    float error;
    Pixel pixel;
    std::uint32_t tile;
  };
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    for (const Pixel& pixel : pixels_of(layout, i)) {
      const std::size_t index = index_of(pixel);
      if (facts_[index].region < 0 || sampled_at_[index] >= 0) continue;
      const bool hard = is_hard(index);
      if (hard || options_.seconds > 0.0)
        found.push_back({hard, relative_error_of(index), pixel, static_cast<std::uint32_t>(i)});
    }
  }
  if (options_.seconds > 0.0) {
    std::ranges::stable_sort(found, std::greater(),
                             [](const Candidate& c) { return std::pair(c.hard, c.error); });
  }
  std::vector<Sampled> result;
  result.reserve(found.size());
  for (const Candidate& c : found) result.push_back(Sampled{.pixel = c.pixel, .tile = c.tile, .hard = true});
  return result;
}

void HardPixels::gather_within(double share, const PhaseTimer& timer, const std::vector<Sampled>& all,
                               const RunControl& control, RayCounts& counts) {
  if (options_.seconds == 0.0) return gather(all, control, counts);
  double now = timer.elapsed().seconds;
  for (std::size_t next = 0; next < all.size() && !control.stopped();) {
    // Half of what the time seems to be enough for.
    std::size_t count = kFewestAtOnce;
    if (seconds_per_pixel_ > 0.0) {
      const double affordable = (share * options_.seconds - now) / seconds_per_pixel_;
      if (affordable < kFewestAtOnce) break;
      count = std::max(static_cast<std::size_t>(0.5 * affordable), kFewestAtOnce);
    }
    count = std::min(all.size() - next, count);
    gather({all.begin() + static_cast<std::ptrdiff_t>(next),
            all.begin() + static_cast<std::ptrdiff_t>(next + count)},
           control, counts);
    next += count;
    const double before = std::exchange(now, timer.elapsed().seconds);
    seconds_per_pixel_ = (now - before) / static_cast<double>(count);
  }
}

void HardPixels::gather(std::vector<Sampled> chosen, const RunControl& control, RayCounts& counts) {
  gather_at(chosen, control, counts);
  if (control.stopped()) return;
  for (const Sampled& s : chosen) {
    std::int32_t& at = sampled_at_[index_of(s.pixel)];
    if (at >= 0) {
      sampled_[static_cast<std::size_t>(at)] = s;
      continue;
    }
    at = static_cast<std::int32_t>(sampled_.size());
    sampled_.push_back(s);
    if (s.hard) ++count_;
  }
}

void HardPixels::gather_further(const RunControl& control, RayCounts& counts) {
  for (int round = 0; round < kFurtherRounds && !control.stopped(); ++round) {
    std::vector<float> left(sampled_.size());
    parallel_for(sampled_.size(), [&](std::size_t i) {
      if (sampled_[i].hard) left[i] = correction_of(sampled_[i].pixel).error;
    });
    std::vector<Sampled> chosen;
    for (std::size_t i = 0; i < sampled_.size(); ++i) {
      if (left[i] > accepted()) chosen.push_back(sampled_[i]);
    }
    if (chosen.empty()) return;
    gather(std::move(chosen), control, counts);
    find_detail();
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
  for_each_traced(scene_, film_, pixels, options_.further_edge_samples, counts, [&](const Tile& tile) {
    std::size_t at = 0;  // the tile holds some of the pixels in their order
    for (std::size_t i = 0; i < tile.pixels.size(); ++i, ++at) {
      while (index_of(pixels[at]) != index_of(tile.pixels[i])) ++at;
      const auto begin = tile.points.begin() + static_cast<std::ptrdiff_t>(i) * tile.packets_per_pixel;
      points[at].insert(points[at].end(), begin, begin + tile.packets_per_pixel);
    }
  });
  PixelGatherer::Surfaces surfaces;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Sampled& s = chosen[i];
    const std::size_t index = index_of(s.pixel);
    const PixelFacts& facts = facts_[index];
    const float* pixel = image_.pixel(s.pixel.x, s.pixel.y) + first_;
    const Rgb interpolated(pixel[0], pixel[1], pixel[2]);
    const int log2_rays =
        s.rays > 0.0 ? static_cast<int>(std::log2(s.rays)) + kLog2Further : log2_rays_of_half(options_.error);
    const double rays = std::exp2(log2_rays);
    const auto share = static_cast<float>(rays / (s.rays + rays));
    Rgb residual = Rgb::Zero();
    for (std::size_t half = 0; half < 2; ++half) {
      const std::array<double, 3> sum = gatherer_.gather(
          points[i], log2_rays, hash(s.pixel.x, s.pixel.y, half + 2 * static_cast<std::size_t>(s.rays)),
          surfaces, counts);
      Rgb light;
      for (int c = 0; c < 3; ++c)
        light[c] = static_cast<float>(sum[static_cast<std::size_t>(c)] / facts.samples);
      residual += 0.5f * (light - interpolated);
      const float difference = (luminance(light) - facts.luminance) / scale_[index];
      s.difference[half] += share * (difference - s.difference[half]);
    }
    s.residual += share * (residual - s.residual);
    s.rays += rays;
    s.bias = s.difference[0] * s.difference[1];
    s.noise = 0.25f * (s.difference[0] - s.difference[1]) * (s.difference[0] - s.difference[1]);
  }
}

/// Scales the estimates of all pixels so that in the survey those without edges are right on average, as far
/// as its noise allows. With an edge they are no lower than the average of such pixels.
void HardPixels::calibrate(const TileLayout& layout) {
  double measured = 0.0, squares = 0.0, estimated = 0.0, pixels = 0.0;
  double edges = kPriorEdges, edge_error = kPriorEdges * static_cast<double>(accepted());
  for (const Sampled& s : sampled_) {
    if (facts_[index_of(s.pixel)].sees_edge) {
      edge_error += static_cast<double>(s.bias);
      ++edges;
    }
    if (s.hard) continue;
    measured += static_cast<double>(s.bias);
    squares += static_cast<double>(s.bias) * static_cast<double>(s.bias);
    estimated += static_cast<double>(relative_error_of(index_of(s.pixel)));
    ++pixels;
  }
  const auto least = static_cast<float>(std::max(edge_error / edges, 0.0));
  double factor = 1.0;
  if (estimated > 0.0) {
    const double relative = measured / estimated;
    const double variance = (squares - measured * measured / pixels) / (estimated * estimated);
    const double share = kPriorDeviation * kPriorDeviation / (kPriorDeviation * kPriorDeviation + variance);
    factor = std::clamp(1.0 + share * (relative - 1.0), 1.0 / kMostCalibration, kMostCalibration);
  }
  parallel_for(layout.count(), [&](std::size_t i) {
    for (const Pixel& p : pixels_of(layout, i)) {
      PixelFacts& facts = facts_[index_of(p)];
      facts.squared_error *= static_cast<float>(factor);
      if (facts.sees_edge)
        facts.squared_error = std::max(facts.squared_error, least * square_scale_of(index_of(p)));
    }
  });
}

template <typename Body>
void HardPixels::for_each_alike(const Pixel& pixel, const Body& body) const {
  static const auto kWeights = [] {
    std::array<float, kAround + 1> w{};
    for (int i = 0; i <= kAround; ++i)
      w[static_cast<std::size_t>(i)] = std::exp(-0.5f * static_cast<float>(i * i) / (kSpread * kSpread));
    return w;
  }();
  const Camera& camera = scene_.camera();
  const PixelFacts& own = facts_[index_of(pixel)];
  const float own_scale = scale_[index_of(pixel)];
  for (int y = std::max(pixel.y - kAround, 0); y <= std::min(pixel.y + kAround, camera.height - 1); ++y) {
    for (int x = std::max(pixel.x - kAround, 0); x <= std::min(pixel.x + kAround, camera.width - 1); ++x) {
      const std::size_t index = index_of({x, y});
      const PixelFacts& other = facts_[index];
      const float brightness = scale_[index] / own_scale;
      if (other.region != own.region || other.sees_edge != own.sees_edge ||
          other.normal.dot(own.normal) < kSimilarNormal || brightness > kSimilarBrightness ||
          brightness * kSimilarBrightness < 1.0f)
        continue;
      const std::int32_t at = sampled_at_[index];
      body(kWeights[static_cast<std::size_t>(std::abs(x - pixel.x))] *
               kWeights[static_cast<std::size_t>(std::abs(y - pixel.y))],
           at < 0 ? nullptr : &sampled_[static_cast<std::size_t>(at)]);
    }
  }
}

float HardPixels::Around::trust(float noise_of_one) const {
  return 1.0f / (1.0f + noise_of_one / std::max(kUnusualNoise * usual_noise, 1e-20f));
}

HardPixels::Around HardPixels::around(const Pixel& pixel) const {
  Around a;
  float all = 0.0f, gathered = 0.0f, squares = 0.0f, detail_squares = 0.0f;
  for_each_alike(pixel, [&](float weight, const Sampled* s) {
    all += weight;
    if (s == nullptr || !s->hard) return;
    gathered += weight;
    a.usual_noise += weight * std::sqrt(s->noise);
  });
  if (gathered == 0.0f) return a;
  a.usual_noise *= a.usual_noise / (gathered * gathered);
  for_each_alike(pixel, [&](float weight, const Sampled* s) {
    if (s == nullptr || !s->hard) return;
    weight *= a.trust(s->noise);
    a.weight += weight;
    squares += weight * weight;
    a.residual += weight * s->residual;
    for (std::size_t half = 0; half < 2; ++half) a.difference[half] += weight * s->difference[half];
    a.bias += weight * s->bias;
    a.noise += weight * s->noise;
    a.detail += weight * s->detail;
    detail_squares += weight * weight * s->detail * s->detail;
  });
  const float scale = 1.0f / a.weight;
  a.residual *= scale;
  for (float& d : a.difference) d *= scale;
  // What the records tell counts as the pixel itself once more, and noise does not make less of it.
  a.bias = (std::max(a.bias, 0.0f) + relative_error_of(index_of(pixel))) / (a.weight + 1.0f);
  a.noise *= scale;
  // Only what stands out from its own scatter: else single pixels would keep their noise.
  a.sure_detail = std::max(scale * (a.detail - std::sqrt(detail_squares)), 0.0f);
  a.detail = std::max(scale * a.detail, 0.0f);
  a.noise_of_mean = a.noise * squares * scale * scale;
  a.share = std::min(1.0f, 2.0f * gathered / all);
  return a;
}

void HardPixels::find_detail() {
  std::vector<float> detail(sampled_.size());
  parallel_for(sampled_.size(), [&](std::size_t i) {
    const Sampled& s = sampled_[i];
    if (!s.hard) return;
    const Around a = around(s.pixel);
    // Each half against the other's mean; what a half's own noise adds to its mean is taken out.
    detail[i] = (a.difference[0] - s.difference[1]) * (a.difference[1] - s.difference[0]) +
                4.0f * a.trust(s.noise) / a.weight * s.noise;
  });
  for (std::size_t i = 0; i < sampled_.size(); ++i) sampled_[i].detail = detail[i];
}

HardPixels::Correction HardPixels::correction_of(const Pixel& pixel) const {
  const Around a = around(pixel);
  if (a.weight == 0.0f) return {};
  const float mean_share = a.share * ratio(a.bias, a.noise_of_mean);
  const float unmoved = 1.0f - mean_share;
  Correction result{mean_share * a.residual, unmoved * unmoved * relative_error_of(index_of(pixel)) +
                                                 mean_share * mean_share * a.noise_of_mean};
  const std::int32_t at = sampled_at_[index_of(pixel)];
  if (at >= 0 && sampled_[static_cast<std::size_t>(at)].hard) {
    const Sampled& own = sampled_[static_cast<std::size_t>(at)];
    // Where both of its gathers say so, a pixel stands out whatever those around do, as thin rims do.
    const float own_noise = std::max(a.noise, own.noise);
    const bool stands_out = own.detail > std::max(kSignificant * own_noise, a.sure_detail);
    const float noise = stands_out ? own_noise : a.noise;
    const float detail_share = a.share * ratio(stands_out ? own.detail : a.sure_detail, noise);
    result.change += detail_share * (own.residual - a.residual);
    const float kept = 1.0f - detail_share;
    result.error =
        mean_share * a.noise_of_mean + detail_share * detail_share * noise + kept * kept * a.detail;
  }
  return result;
}

std::vector<std::uint8_t> HardPixels::near_hard() const {
  std::vector<std::uint8_t> near(facts_.size(), 0);
  const Camera& camera = scene_.camera();
  for (const Sampled& s : sampled_) {
    if (!s.hard) continue;
    const int x0 = std::max(s.pixel.x - kAround, 0), x1 = std::min(s.pixel.x + kAround, camera.width - 1);
    for (int y = std::max(s.pixel.y - kAround, 0); y <= std::min(s.pixel.y + kAround, camera.height - 1); ++y)
      std::fill_n(near.begin() + static_cast<std::ptrdiff_t>(index_of({x0, y})), x1 - x0 + 1, 1);
  }
  return near;
}

void HardPixels::blend(const TileLayout& layout) {
  // Corrections look at the estimates of pixels around, so these are replaced when all are known.
  std::vector<float> errors(facts_.size(), -1.0f);
  const std::vector<std::uint8_t> near = near_hard();
  parallel_for(layout.count(), [&](std::size_t i) {
    for (const Pixel& p : pixels_of(layout, i)) {
      if (facts_[index_of(p)].region < 0 || near[index_of(p)] == 0) continue;
      const Correction correction = correction_of(p);
      errors[index_of(p)] = correction.error;
      float* pixel = image_.pixel(p.x, p.y) + first_;
      for (int c = 0; c < 3; ++c) pixel[c] = std::max(pixel[c] + correction.change[c], 0.0f);
    }
  });
  for (std::size_t i = 0; i < facts_.size(); ++i) {
    if (errors[i] >= 0.0f) facts_[i].squared_error = errors[i] * square_scale_of(i);
  }
}

void HardPixels::sum_up(const TileLayout& layout) {
  double sum = 0.0, pixels = 0.0;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    for (const Pixel& p : pixels_of(layout, i)) {
      const PixelFacts& facts = facts_[index_of(p)];
      if (facts.region < 0) continue;
      sum += static_cast<double>(facts.total_error() / square_scale_of(index_of(p)));
      ++pixels;
    }
  }
  relative_error_ = std::sqrt(sum / std::max(pixels, 1.0));
}

void HardPixels::refine(const TileLayout& layout, const RunControl& control, RayCounts& counts) {
  const PhaseTimer timer("hard pixels");
  gather_within(kMostForSurvey, timer, survey(layout), control, counts);
  calibrate(layout);
  gather_within(1.0, timer, candidates(layout), control, counts);
  find_detail();
  if (options_.seconds == 0.0) gather_further(control, counts);
  if (control.stopped()) return;
  blend(layout);
  sum_up(layout);
}

}  // namespace vrc
