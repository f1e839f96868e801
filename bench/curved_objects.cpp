// SPDX-License-Identifier: GPL-3.0-or-later
// Compares ways to cache radiance on curved objects, at about equal CPU time or with equally many records:
// error of the indirect light of one bounce over the pixels of curved surfaces and over all.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>

#include "bench_support.h"
#include "placement/baselines.h"
#include "placement/presets.h"
#include "transport/film_sampler.h"

namespace vrc::bench {
namespace {

constexpr double kCloseEnough = 1.05;  // ratio of times at which the search ends
constexpr double kCostExponent = 1.2;  // time grows about as error^-kCostExponent
constexpr double kSmallestError = 1e-3, kLargestError = 2.0;

struct Settings : PictureSettings {
  std::vector<std::string> variants;
  double seconds = 1.5;
  std::vector<double> errors;
  int records = 0;
  int search_runs = 6;
  int gather_rays = 0;
  int harmonics_order = 0;
  bool markdown = false;

  Settings() {
    width = height = 256;
    for (const char* object : {"sphere", "torus", "bowl", "small_sphere"})
      scenes.push_back(fmt::format(VRC_SOURCE_DIR "/scenes/object_{}.xml", object));
  }
};

/// What records hold is compared by what they interpolate.
CacheOptions records_alone() {
  CacheOptions options;
  options.supersample_edges = options.hard_pixels = options.error_of_picture = false;
  return options;
}

CacheOptions analytic() {
  CacheOptions options = records_alone();
  options.representation = Representation::kAnalytic;
  return options;
}

CacheOptions harmonics(int order) {
  CacheOptions options = records_alone();
  options.representation = Representation::kHarmonics;
  options.harmonics_order = order;
  return options;
}

CacheOptions hybrid(HarmonicsRule rule) {
  CacheOptions options = records_alone();
  options.representation = Representation::kHybrid;
  options.harmonics_rule = rule;
  return options;
}

/// The paper's records of radiance alone, on curved surfaces too.
CacheOptions paper_flat() {
  CacheOptions options = paper_preset({});
  options.representation = Representation::kAnalytic;
  return options;
}

/// Derivatives and weights that do not know the curvature [Zhao eq. 10-11, 14].
CacheOptions flat(CacheOptions options) {
  options.total_derivative = options.joint_weight = false;
  return options;
}

CacheOptions strategy(Strategy strategy, CacheOptions options) {
  options.strategy = strategy;
  return options;
}

const std::vector<std::pair<std::string, CacheOptions>>& all_variants() {
  static const std::vector<std::pair<std::string, CacheOptions>> variants = {
      {"flat", flat(analytic())},
      {"total", analytic()},
      {"sh8", harmonics(8)},
      {"sh10", harmonics(10)},
      {"sh16", harmonics(16)},
      {"sh24", harmonics(24)},
      {"paper-flat", paper_flat()},
      {"paper", paper_preset({})},
      {"paper-total", hybrid(HarmonicsRule::kPaper)},
      {"auto", hybrid(HarmonicsRule::kAuto)},
      {"default", {}},
      {"independent", strategy(Strategy::kViewIndependent, analytic())},
      {"independent-outgoing", strategy(Strategy::kViewIndependentOutgoing, analytic())},
      {"independent-sh", strategy(Strategy::kViewIndependent, harmonics(10))},
      {"krivanek", baseline_options(Baseline::kKrivanek, harmonics(10))},
  };
  return variants;
}

/// Pixels whose centre shows a triangle with shading normals of its own.
PixelMask curved_pixels(const Scene& scene) {
  const Camera& camera = scene.camera();
  PixelMask mask;
  mask.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; x += kLanes) {
      const F16 film_x = to_float(lane_index()) + (static_cast<float>(x) + 0.5f);
      const V3x16 direction = camera_directions(camera, film_x, splat(static_cast<float>(y) + 0.5f));
      const SurfacePoint16 p =
          scene.intersect(lane_index() < camera.width - x, {splat3(camera.origin), direction, splat(1e17f)},
                          RayTracer::Coherence::kCoherent);
      for (int i = 0; i < std::min(kLanes, camera.width - x); ++i) {
        const bool hit = p.hit[i] != 0;
        mask.push_back(hit && scene.triangles()[static_cast<std::size_t>(p.triangle[i])].smooth != 0);
      }
    }
  }
  return mask;
}

/// A scene with what its pictures are compared with.
struct Subject {
  const Scene& scene;
  References references;
  PixelMask object;
};

struct Run {
  double cpu_seconds = 0.0;
  double object_error = 0.0, error = 0.0;
  double records = 0.0, harmonics_records = 0.0;
};

/// CPU seconds of placing and interpolating: without charts and tables of BRDFs, which a scene needs
/// once, and without the classes, which are only reported.
double working_time(const RenderStats& stats) {
  static const std::set<std::string, std::less<>> kPhases = {"place records", "fit records", "render",
                                                             "hard pixels"};
  double sum = 0.0;
  for (const PhaseTime& phase : stats.phases) {
    if (kPhases.contains(phase.name)) sum += phase.cpu_seconds;
  }
  return sum;
}

Run run(const Subject& subject, const CacheOptions& cache, int samples_per_pixel, std::uint64_t seed) {
  RenderOptions options = indirect_light(Method::kCache, samples_per_pixel, seed);
  options.cache = cache;
  options.cache.classify_sites = false;
  const RenderResult rendered = render(subject.scene, options);
  Run result;
  result.cpu_seconds = working_time(rendered.stats);
  result.object_error = subject.references.error_of(rendered.image, subject.object);
  result.error = subject.references.error_of(rendered.image);
  const auto records = rendered.cache->records();
  result.records = static_cast<double>(records.size());
  result.harmonics_records =
      static_cast<double>(std::ranges::count_if(records, &RadianceRecord::uses_harmonics));
  return result;
}

/// The error threshold at which a run takes the time that is nearest to the wanted one.
double error_for_time(const Subject& subject, CacheOptions cache, const Settings& settings) {
  std::map<double, double> times;  // by error threshold
  const auto distance = [&](const auto& entry) {
    return std::abs(std::log(entry.second / settings.seconds));
  };
  const auto nearest = [&] { return *std::ranges::min_element(times, {}, distance); };
  cache.error = CacheOptions{}.error;
  for (int i = 0; i < settings.search_runs && !times.contains(cache.error); ++i) {
    times[cache.error] = run(subject, cache, settings.samples_per_pixel, 1).cpu_seconds;
    if (distance(nearest()) < std::log(kCloseEnough)) break;
    const auto slow = std::ranges::find_if(times.rbegin(), times.rend(),
                                           [&](const auto& t) { return t.second > settings.seconds; });
    const auto fast =
        std::ranges::find_if(times, [&](const auto& t) { return t.second <= settings.seconds; });
    if (slow != times.rend() && fast != times.end() && slow->first < fast->first) {
      cache.error = std::sqrt(slow->first * fast->first);
    } else {
      const auto [error, time] = nearest();
      const double factor = std::pow(time / settings.seconds, 1.0 / kCostExponent);
      cache.error = std::clamp(error * std::clamp(factor, 0.2, 5.0), kSmallestError, kLargestError);
    }
  }
  return nearest().first;
}

double median_of(const std::vector<Run>& runs, double Run::*member) {
  std::vector<double> values;
  for (const Run& r : runs) values.push_back(r.*member);
  return median(std::move(values));
}

void print_header(bool markdown) {
  if (markdown) {
    fmt::print(
        "| variant | `--error` | records | SH | CPU s | object | all |\n|---|---|---|---|---|---|---|\n");
  } else {
    fmt::print("{:12} {:>8} {:>8} {:>8} {:>8} {:>11} {:>11}\n", "variant", "error", "records", "SH", "CPU s",
               "object", "all");
  }
}

void measure(const Subject& subject, const std::string& name, const CacheOptions& cache,
             const Settings& settings) {
  std::vector<Run> runs;
  for (int i = 0; i < settings.repeats; ++i) {
    runs.push_back(run(subject, cache, settings.samples_per_pixel, static_cast<std::uint64_t>(i + 1)));
  }
  const std::string error = cache.records > 0 ? "-" : fmt::format("{:.3g}", cache.error);
  const auto print = [&](auto format) {
    fmt::print(fmt::runtime(format), name, error, median_of(runs, &Run::records),
               median_of(runs, &Run::harmonics_records), median_of(runs, &Run::cpu_seconds),
               median_of(runs, &Run::object_error), median_of(runs, &Run::error));
  };
  print(settings.markdown ? "| {} | {} | {:.0f} | {:.0f} | {:.2f} | {:.2e} | {:.2e} |\n"
                          : "{:12} {:>8} {:>8.0f} {:>8.0f} {:>8.2f} {:>11.3e} {:>11.3e}\n");
  std::fflush(stdout);
}

void compare(const Subject& subject, const std::string& name, CacheOptions cache, const Settings& settings) {
  cache.gather_rays = settings.gather_rays;
  cache.records = settings.records;
  if (settings.harmonics_order > 0) cache.harmonics_order = settings.harmonics_order;
  std::vector<double> errors = settings.errors;
  if (errors.empty()) errors = {cache.records > 0 ? cache.error : error_for_time(subject, cache, settings)};
  for (const double error : errors) {
    cache.error = error;
    measure(subject, name, cache, settings);
  }
}

void run_scene(const std::string& file, const Settings& settings) {
  const SceneDescription description = read_scene_for(file, settings);
  const Scene scene(description);
  const Subject subject = {scene, make_references(scene, description, file, settings), curved_pixels(scene)};
  const auto object_size = std::ranges::count(subject.object, true);
  fmt::print("\n{}{}, {}x{}, {} samples a pixel, {} pixels of curved surfaces, {}\n\n",
             std::filesystem::path(file).stem().string(),
             settings.defines.empty() ? "" : fmt::format(" ({})", fmt::join(settings.defines, ", ")),
             settings.width, settings.height, settings.samples_per_pixel, object_size,
             settings.records > 0      ? fmt::format("{} records", settings.records)
             : settings.errors.empty() ? fmt::format("{:g} CPU seconds", settings.seconds)
                                       : std::string("error thresholds"));
  print_header(settings.markdown);
  for (const auto& [name, options] : all_variants()) {
    const bool wanted = settings.variants.empty() || std::ranges::count(settings.variants, name) > 0;
    if (wanted) compare(subject, name, options, settings);
  }
}

void declare_options(CLI::App& app, Settings& settings) {
  declare_picture_options(app, settings);
  std::vector<std::string> names;
  for (const auto& [name, options] : all_variants()) names.push_back(name);
  app.add_option("--variant", settings.variants, "Ways to cache; all by default")
      ->check(CLI::IsMember(names));
  CLI::Option* seconds =
      app.add_option("--seconds", settings.seconds, "CPU seconds that every variant is brought near to")
          ->check(CLI::PositiveNumber)
          ->capture_default_str();
  app.add_option("--records", settings.records, "Give every variant this many records instead")
      ->check(CLI::PositiveNumber)
      ->excludes(seconds);
  app.add_option("--error", settings.errors, "Compare at these thresholds instead")
      ->check(CLI::PositiveNumber)
      ->excludes(seconds);
  app.add_option("--sh-order", settings.harmonics_order, "Order of spherical harmonics of all variants")
      ->check(CLI::Range(1, sh::kMaxFrameOrder));
  app.add_option("--search-runs", settings.search_runs, "Runs that look for the time")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--gather-rays", settings.gather_rays, "Rays of a record; 0 chooses by the noise")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--markdown", settings.markdown, "Print tables for the documentation");
}

}  // namespace
}  // namespace vrc::bench

int main(int argc, char** argv) {
  using namespace vrc;
  using namespace vrc::bench;
  Settings settings;
  CLI::App app("Ways to cache radiance on curved objects, at equal CPU time");
  declare_options(app, settings);
  CLI11_PARSE(app, argc, argv);
  return run_reported("bench_curved_objects", settings, [&] {
    for (const std::string& scene : settings.scenes) run_scene(scene, settings);
  });
}
