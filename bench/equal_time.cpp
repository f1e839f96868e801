// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the radiance cache with path tracing at equal CPU time: error of the indirect light of one
// bounce against two independent references by path tracing, kept in files from run to run.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bench_support.h"
#include "io/atomic_file.h"

namespace vrc::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Settings : PictureSettings {
  std::vector<double> errors;
  std::vector<int> records;
  std::vector<double> seconds;
  std::vector<std::string> samplers = {"image"};
  int gather_rays = 0;
  bool cache_only = false;
  bool guided = true;
  bool error_of_picture = true;
  std::string json_file;

  Settings() {
    scenes = {VRC_SOURCE_DIR "/scenes/half_box.xml", VRC_SOURCE_DIR "/scenes/cornell_glossy.xml"};
  }
};

struct Measurement {
  double cpu_seconds = 0.0;
  double relmse = 0.0;
  Image error_blocks;  ///< Of the cache's pictures.
  RenderStats stats;
};

Measurement measure(const Scene& scene, const RenderOptions& options, const References& references) {
  Measurement result;
  const double begin = process_cpu_seconds();
  const RenderResult rendered = render(scene, options);
  result.cpu_seconds = process_cpu_seconds() - begin;
  result.relmse = references.error_of(rendered.image);
  if (options.method == Method::kCache) result.error_blocks = references.error_blocks(rendered.image);
  result.stats = rendered.stats;
  return result;
}

/// Medians over the repeats; the values of all repeats go to the JSON file.
struct Series {
  std::vector<double> cpu_seconds, relmse;

  void add(const Measurement& m) {
    cpu_seconds.push_back(m.cpu_seconds);
    relmse.push_back(m.relmse);
  }
  [[nodiscard]] double cpu() const { return median(cpu_seconds); }
  [[nodiscard]] double error() const { return median(relmse); }
  [[nodiscard]] json to_json() const {
    return {{"cpu_seconds", cpu()},
            {"relmse", error()},
            {"all_cpu_seconds", cpu_seconds},
            {"all_relmse", relmse}};
  }
};

/// Samples per pixel that path tracing finishes in about `seconds`. Rays are traced in packets of
/// sixteen: beyond one packet only whole packets are used, which is to the path tracer's benefit.
int equal_time_samples(const Scene& scene, double seconds) {
  const auto cost = [&](int samples) {
    const double begin = process_cpu_seconds();
    (void)render(scene, indirect_light(Method::kPath, samples, 99));
    return process_cpu_seconds() - begin;
  };
  const double packet_cost = cost(16);
  if (seconds >= packet_cost) return 16 * std::max(1, static_cast<int>(std::lround(seconds / packet_cost)));
  int samples = 15;
  while (samples > 1 && cost(samples) > seconds) --samples;
  return samples;
}

struct CacheSetting {
  std::string label;
  CacheOptions options;
  double seconds = 0.0;  ///< RenderOptions::seconds.
};

std::vector<CacheSetting> cache_settings(const Settings& settings) {
  CacheOptions base;
  base.gather_rays = settings.gather_rays;
  base.guided = settings.guided;
  base.error_of_picture = settings.error_of_picture;
  std::vector<CacheSetting> result;
  for (const std::string& sampler : settings.samplers) {
    base.sampler = sampler == "surface" ? Sampler::kSurface : Sampler::kImage;
    const std::string suffix = settings.samplers.size() > 1 ? " " + sampler : "";
    std::vector<double> errors = settings.errors;
    if (errors.empty() && settings.records.empty() && settings.seconds.empty()) errors.push_back(base.error);
    for (const double error : errors) {
      result.push_back({fmt::format("error {:g}{}", error, suffix), base, 0.0});
      result.back().options.error = error;
    }
    for (const int records : settings.records) {
      result.push_back({fmt::format("records {}{}", records, suffix), base, 0.0});
      result.back().options.records = records;
    }
    for (const double seconds : settings.seconds)
      result.push_back({fmt::format("time {:g}{}", seconds, suffix), base, seconds});
  }
  return result;
}

/// How well the layers error.Y of pictures of several seeds foretell errors: medians over the seeds.
struct Foretold {
  EstimateQuality own;       ///< Of the picture's own error.
  EstimateQuality expected;  ///< Of the root mean square of all seeds' errors.
};

Foretold foretold(std::vector<Image> blocks) {
  const auto medians = [&blocks]() -> EstimateQuality {
    std::vector<double> within_two, measurable;
    for (const Image& b : blocks) {
      const EstimateQuality quality = estimate_quality(b);
      within_two.push_back(quality.within_two);
      measurable.push_back(quality.measurable);
    }
    return {median(within_two), median(measurable)};
  };
  const EstimateQuality own = medians();
  for (std::size_t i = 0; i < blocks.front().pixels.size(); i += blocks.front().channels.size()) {
    float sum = 0.0f;
    for (const Image& b : blocks) sum += b.pixels[i];
    for (Image& b : blocks) b.pixels[i] = sum / static_cast<float>(blocks.size());
  }
  return {own, medians()};
}

void print_details(const Measurement& m, const Foretold& f, int seeds) {
  fmt::print("{:20}", "");
  for (const PhaseTime& phase : m.stats.phases) fmt::print("  {} {:.2f} s", phase.name, phase.cpu_seconds);
  fmt::print("  gather rays {:.1f} M\n", 1e-6 * static_cast<double>(m.stats.gather_rays));
  const auto told = [](const EstimateQuality& q) {
    return fmt::format("{:.0f} % of the {:.0f} % of blocks that can be told", 100.0 * q.within_two,
                       100.0 * q.measurable);
  };
  fmt::print("{:20}  records for {:.3f}, estimated relMSE {:.2e}\n", "", m.stats.records_error,
             m.stats.relative_error * m.stats.relative_error);
  fmt::print("{:20}  within a factor of two in {}, of the expected error (of {} seeds) in {}\n", "",
             told(f.own), seeds, told(f.expected));
}

json compare(const Scene& scene, const References& references, const CacheSetting& setting,
             const Settings& settings) {
  Series cache, path;
  std::vector<double> records;
  std::vector<Image> blocks;
  Measurement last;
  for (int i = 0; i < settings.repeats; ++i) {
    RenderOptions options =
        indirect_light(Method::kCache, settings.samples_per_pixel, static_cast<std::uint64_t>(i + 1));
    options.cache = setting.options;
    options.cache.classify_sites = false;
    options.seconds = setting.seconds;
    const Measurement m = measure(scene, options, references);
    cache.add(m);
    records.push_back(static_cast<double>(m.stats.records));
    blocks.push_back(m.error_blocks);
    last = m;
  }
  json row = {{"setting", setting.label}, {"records", median(records)}, {"cache", cache.to_json()}};
  const Foretold f = foretold(blocks);
  row["estimate_within_two"] = f.own.within_two;
  row["estimate_within_two_of_expected"] = f.expected.within_two;
  fmt::print("{:20} {:>8.0f} {:>9.2f} {:>10.3e}", setting.label, median(records), cache.cpu(), cache.error());
  if (!settings.cache_only) {
    const int samples = equal_time_samples(scene, cache.cpu());
    for (int i = 0; i < settings.repeats; ++i) {
      path.add(measure(scene, indirect_light(Method::kPath, samples, static_cast<std::uint64_t>(i + 1)),
                       references));
    }
    // The error of path tracing falls as 1 / time: what is left of the times' difference is taken out.
    const double ratio = path.error() * (path.cpu() / cache.cpu()) / cache.error();
    row["path"] = path.to_json();
    row["path"]["samples_per_pixel"] = samples;
    row["error_ratio_at_equal_time"] = ratio;
    fmt::print(" {:>6} {:>9.2f} {:>10.3e} {:>8.1f}", samples, path.cpu(), path.error(), ratio);
  }
  fmt::print("\n");
  print_details(last, f, settings.repeats);
  std::fflush(stdout);
  return row;
}

json run_scene(const std::string& file, const Settings& settings) {
  const SceneDescription description = read_scene_for(file, settings);
  const Scene scene(description);
  const References references = make_references(scene, description, file, settings);

  fmt::print("\n{}, {}x{}, {} samples a pixel\n", fs::path(file).filename().string(), settings.width,
             settings.height, settings.samples_per_pixel);
  fmt::print("{:20} {:>8} {:>9} {:>10}", "cache", "records", "CPU s", "relMSE");
  fmt::print("{}\n", settings.cache_only
                         ? ""
                         : fmt::format(" {:>6} {:>9} {:>10} {:>8}", "spp", "CPU s", "relMSE", "ratio"));
  json rows = json::array();
  for (const CacheSetting& setting : cache_settings(settings)) {
    rows.push_back(compare(scene, references, setting, settings));
  }
  return {{"scene", file}, {"rows", rows}};
}

void declare_options(CLI::App& app, Settings& settings) {
  declare_picture_options(app, settings);
  app.add_option("--error", settings.errors, "Error thresholds of the cache")->check(CLI::PositiveNumber);
  app.add_option("--time", settings.seconds, "Wall-clock seconds of the cache")->check(CLI::PositiveNumber);
  app.add_option("--records", settings.records, "Numbers of records")->check(CLI::PositiveNumber);
  app.add_option("--sampler", settings.samplers, "image, surface or both")
      ->check(CLI::IsMember({"image", "surface"}));
  app.add_option("--gather-rays", settings.gather_rays, "Rays of a record; 0 chooses by sharpness")
      ->check(CLI::NonNegativeNumber);
  app.add_flag_callback(
      "--error-of-records", [&settings] { settings.error_of_picture = false; },
      "--error is what records are placed for, not the picture's");
  app.add_flag_callback(
      "--unguided", [&settings] { settings.guided = false; }, "Without guided gathers");
  app.add_option_function<std::string>(
         "--method-only", [&](const std::string&) { settings.cache_only = true; }, "Leave out path tracing")
      ->check(CLI::IsMember({"cache"}));
  app.add_option("--json", settings.json_file, "Write all figures to this file");
}

}  // namespace
}  // namespace vrc::bench

int main(int argc, char** argv) {
  using namespace vrc;
  using namespace vrc::bench;
  Settings settings;
  CLI::App app("Radiance cache against path tracing at equal CPU time");
  declare_options(app, settings);
  CLI11_PARSE(app, argc, argv);
  return run_reported("bench_equal_time", settings, [&] {
    json scenes = json::array();
    for (const std::string& scene : settings.scenes) scenes.push_back(run_scene(scene, settings));
    if (!settings.json_file.empty()) {
      const json all = {{"width", settings.width},
                        {"height", settings.height},
                        {"threads", settings.threads},
                        {"samples_per_pixel", settings.samples_per_pixel},
                        {"reference_samples_per_pixel", settings.reference_samples},
                        {"scenes", scenes}};
      write_file_atomically(settings.json_file, all.dump(2) + "\n");
    }
  });
}
