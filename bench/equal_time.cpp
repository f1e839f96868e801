// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the radiance cache with path tracing at equal CPU time: error of the indirect light of one
// bounce against two independent references by path tracing, kept in files from run to run.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "core/hash.h"
#include "core/image_error.h"
#include "core/parallel.h"
#include "io/atomic_file.h"
#include "io/image_io.h"
#include "io/scene_reader.h"
#include "shading/render.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kReferenceLuminance = 0.5;    // Errors are relative to 0.01 at this mean luminance.
constexpr std::uint64_t kReferenceFormat = 1;  // Raise when the path tracer's result changes.
constexpr std::uint64_t kFirstReferenceSeed = 0x5eed0001;  // Far from those of the measured pictures.

struct Settings {
  std::vector<std::string> scenes = {VRC_SOURCE_DIR "/scenes/half_box.xml",
                                     VRC_SOURCE_DIR "/scenes/cornell_glossy.xml"};
  std::vector<std::string> defines;
  std::vector<double> errors;
  std::vector<int> records;
  std::vector<std::string> samplers = {"image"};
  int width = 512, height = 512;
  int samples_per_pixel = 16;
  int reference_samples = 2048;
  int repeats = 3;
  int threads = 2;
  int gather_rays = 0;
  bool cache_only = false;
  std::string reference_dir = VRC_SOURCE_DIR "/build/references";
  std::string json_file;
};

/// Hashes what a scene description says, so that a reference is used for nothing else.
class DescriptionHash {
 public:
  explicit DescriptionHash(const SceneDescription& scene) {
    for (const ShapeDescription& shape : scene.shapes) add_shape(shape);
    for (const Material& material : scene.materials) add_material(material);
    for (const DeltaLight& light : scene.delta_lights) {
      std::visit([&](const auto& l) { add_light(l); }, light);
    }
    add(scene.environment);
    const Camera& camera = scene.camera;
    for (const Vec3& v : {camera.origin, camera.right, camera.up, camera.forward}) add(v);
    add_number(camera.tan_half_width);
    add_number(camera.width);
    add_number(camera.height);
    add_number(static_cast<int>(scene.film.filter));
    add_number(scene.film.gaussian_stddev);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

  /// Adds the bit pattern of a number.
  template <typename T>
  void add_number(T number) {
    std::uint64_t bits = 0;
    static_assert(sizeof(T) <= sizeof(bits) && std::is_arithmetic_v<T>);
    std::memcpy(&bits, &number, sizeof(T));
    value_ = hash(value_, bits);
  }

 private:
  template <typename Vector>
  void add(const Vector& v) {
    for (int i = 0; i < 3; ++i) add_number(v[i]);
  }
  void add_shape(const ShapeDescription& shape) {
    for (const Vec3& p : shape.soup.positions) add(p);
    for (const Vec3& n : shape.soup.normals) add(n);
    for (const auto* list : {&shape.soup.face_begin, &shape.soup.corner_position, &shape.soup.corner_normal,
                             &shape.soup.face_material, &shape.materials}) {
      add_number(list->size());
      for (const std::uint32_t index : *list) add_number(index);
    }
    for (const Rgb& emission : shape.emission) add(emission);
    add_number(static_cast<int>(shape.face_normals));
  }
  void add_material(const Material& material) {
    add_number(static_cast<int>(material.two_sided));
    for (const Lobe& lobe : material.lobes) {
      add_number(lobe.index());
      std::visit([&](const auto& l) { add_lobe(l); }, lobe);
    }
  }
  void add_lobe(const LambertLobe& lobe) { add(lobe.reflectance); }
  void add_lobe(const PhongLobe& lobe) {
    add(lobe.reflectance);
    add_number(lobe.exponent);
  }
  void add_lobe(const GgxLobe& lobe) {
    for (const Rgb& c : {lobe.reflectance, lobe.eta, lobe.k}) add(c);
    add_number(lobe.alpha);
    add_number(static_cast<int>(lobe.has_fresnel));
  }
  void add_light(const PointLight& light) {
    add(light.position);
    add(light.intensity);
  }
  void add_light(const DirectionalLight& light) {
    add(light.direction);
    add(light.irradiance);
  }

  std::uint64_t value_ = kReferenceFormat;
};

Image rgb_of(const Image& image) {
  Image result(image.width, image.height, {"R", "G", "B"});
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    std::copy_n(image.pixels.data() + p * image.channels.size(), 3, result.pixels.data() + 3 * p);
  }
  return result;
}

/// Indirect light of one bounce.
RenderOptions indirect_light(Method method, int samples_per_pixel, std::uint64_t seed) {
  RenderOptions options;
  options.method = method;
  options.only = Component::kIndirect;
  options.bounces = 1;
  options.samples_per_pixel = samples_per_pixel;
  options.seed = seed;
  return options;
}

/// Two references of independent noise, scaled to a mean luminance of one half.
struct References {
  std::array<Image, 2> halves;
  float scale = 1.0f;  ///< That the halves were multiplied by, and pictures must be.

  [[nodiscard]] double error_of(const Image& image) const {
    Image scaled = rgb_of(image);
    for (float& v : scaled.pixels) v *= scale;
    return two_half_relmse(scaled, halves[0], halves[1]);
  }
};

Image reference_half(const Scene& scene, const fs::path& file, int samples, std::uint64_t seed) {
  if (fs::exists(file)) return read_image(file);
  fmt::print(stderr, "rendering the reference {}\n", file.string());
  Image image = rgb_of(render(scene, indirect_light(Method::kPath, samples, seed)).image);
  write_exr(file, image);
  return image;
}

References make_references(const Scene& scene, const SceneDescription& description, const std::string& name,
                           const Settings& settings) {
  fs::create_directories(settings.reference_dir);
  References references;
  double sum = 0.0;
  for (std::size_t half = 0; half < 2; ++half) {
    DescriptionHash key(description);
    key.add_number(settings.reference_samples);
    const std::string file = fmt::format("{}_{}x{}_{}spp_{:016x}_{}.exr", name, settings.width,
                                         settings.height, settings.reference_samples, key.value(), half + 1);
    references.halves[half] = reference_half(scene, fs::path(settings.reference_dir) / file,
                                             settings.reference_samples, kFirstReferenceSeed + half);
    const Image& image = references.halves[half];
    for (std::size_t p = 0; p < image.pixel_count(); ++p) {
      sum += static_cast<double>(luminance(std::span(image.pixels).subspan(3 * p, 3)));
    }
  }
  const double mean = sum / (2.0 * static_cast<double>(references.halves[0].pixel_count()));
  if (!(mean > 0.0)) throw InputError(description.source, 0, "has no indirect light to compare");
  references.scale = static_cast<float>(kReferenceLuminance / mean);
  for (Image& image : references.halves) {
    for (float& v : image.pixels) v *= references.scale;
  }
  return references;
}

struct Measurement {
  double cpu_seconds = 0.0;
  double relmse = 0.0;
  RenderStats stats;
};

Measurement measure(const Scene& scene, const RenderOptions& options, const References& references) {
  Measurement result;
  const double begin = process_cpu_seconds();
  const RenderResult rendered = render(scene, options);
  result.cpu_seconds = process_cpu_seconds() - begin;
  result.relmse = references.error_of(rendered.image);
  result.stats = rendered.stats;
  return result;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
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
};

std::vector<CacheSetting> cache_settings(const Settings& settings) {
  CacheOptions base;
  base.gather_rays = settings.gather_rays;
  std::vector<CacheSetting> result;
  for (const std::string& sampler : settings.samplers) {
    base.sampler = sampler == "surface" ? Sampler::kSurface : Sampler::kImage;
    const std::string suffix = settings.samplers.size() > 1 ? " " + sampler : "";
    std::vector<double> errors = settings.errors;
    if (errors.empty() && settings.records.empty()) errors.push_back(base.error);
    for (const double error : errors) {
      result.push_back({fmt::format("error {:g}{}", error, suffix), base});
      result.back().options.error = error;
    }
    for (const int records : settings.records) {
      result.push_back({fmt::format("records {}{}", records, suffix), base});
      result.back().options.records = records;
    }
  }
  return result;
}

void print_phases(const RenderStats& stats) {
  fmt::print("{:20}", "");
  for (const PhaseTime& phase : stats.phases) fmt::print("  {} {:.2f} s", phase.name, phase.cpu_seconds);
  fmt::print("  gather rays {:.1f} M\n", 1e-6 * static_cast<double>(stats.gather_rays));
}

json compare(const Scene& scene, const References& references, const CacheSetting& setting,
             const Settings& settings) {
  Series cache, path;
  std::vector<double> records;
  RenderStats last;
  for (int i = 0; i < settings.repeats; ++i) {
    RenderOptions options =
        indirect_light(Method::kCache, settings.samples_per_pixel, static_cast<std::uint64_t>(i + 1));
    options.cache = setting.options;
    const Measurement m = measure(scene, options, references);
    cache.add(m);
    records.push_back(static_cast<double>(m.stats.records));
    last = m.stats;
  }
  json row = {{"setting", setting.label}, {"records", median(records)}, {"cache", cache.to_json()}};
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
  print_phases(last);
  std::fflush(stdout);
  return row;
}

json run_scene(const std::string& file, const Settings& settings) {
  SceneReadOptions read;
  read.width = settings.width;
  read.height = settings.height;
  for (const std::string& define : settings.defines) {
    const std::size_t equals = define.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError(define, 0, "is not of the form NAME=VALUE");
    read.defines[define.substr(0, equals)] = define.substr(equals + 1);
  }
  const SceneDescription description = read_scene(file, read);
  const Scene scene(description);
  const References references = make_references(scene, description, fs::path(file).stem().string(), settings);

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
  app.add_option("scenes", settings.scenes, "Scene files")->capture_default_str();
  app.add_option("-D,--define", settings.defines, "NAME=VALUE: a parameter of the scene files")
      ->allow_extra_args(false);
  app.add_option("--error", settings.errors, "Error thresholds of the cache")->check(CLI::PositiveNumber);
  app.add_option("--records", settings.records, "Numbers of records")->check(CLI::PositiveNumber);
  app.add_option("--sampler", settings.samplers, "image, surface or both")
      ->check(CLI::IsMember({"image", "surface"}));
  app.add_option("--gather-rays", settings.gather_rays, "Rays of a record; 0 chooses by sharpness")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--width", settings.width, "Film width")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--height", settings.height, "Film height")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--spp", settings.samples_per_pixel, "Samples a pixel of the cache's picture")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--reference-spp", settings.reference_samples,
                 "Samples a pixel of each of the two references")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--reference-dir", settings.reference_dir, "Folder of the references")
      ->capture_default_str();
  app.add_option("--repeats", settings.repeats, "Seeds to take medians over")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--threads", settings.threads, "Worker threads")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--method-only", [&](const std::string&) { settings.cache_only = true; }, "Leave out path tracing")
      ->check(CLI::IsMember({"cache"}));
  app.add_option("--json", settings.json_file, "Write all figures to this file");
}

}  // namespace
}  // namespace vrc

int main(int argc, char** argv) {
  using namespace vrc;
  Settings settings;
  CLI::App app("Radiance cache against path tracing at equal CPU time");
  declare_options(app, settings);
  CLI11_PARSE(app, argc, argv);
  try {
    set_thread_count(settings.threads);
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
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_equal_time: {}\n", error.what());
    return 2;
  }
  return 0;
}
