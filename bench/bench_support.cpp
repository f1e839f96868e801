// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_support.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <span>

#include "core/error.h"
#include "core/hash.h"
#include "core/image_error.h"
#include "core/parallel.h"
#include "io/image_io.h"
#include "io/scene_reader.h"

namespace vrc::bench {

namespace fs = std::filesystem;

namespace {

constexpr double kReferenceLuminance = 0.5;    // Errors are relative to 0.01 at this mean luminance.
constexpr std::uint64_t kReferenceFormat = 1;  // Raise when the path tracer's result changes.
constexpr std::uint64_t kFirstReferenceSeed = 0x5eed0001;  // Far from those of the measured pictures.

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

Image reference_of_seed(const Scene& scene, const fs::path& file, const PictureSettings& settings,
                        std::uint64_t seed) {
  if (fs::exists(file)) return read_image(file);
  fmt::print(stderr, "rendering the reference {}\n", file.string());
  RenderOptions options = indirect_light(Method::kPath, settings.reference_samples, seed);
  options.path_rays = settings.reference_rays;
  Image image = rgb_of(render(scene, options).image);
  write_exr(file, image);
  return image;
}

void add_positive(CLI::App& app, const char* name, int& target, const char* help) {
  app.add_option(name, target, help)->check(CLI::PositiveNumber)->capture_default_str();
}

}  // namespace

void declare_scene_options(CLI::App& app, PictureSettings& settings) {
  app.add_option("scenes", settings.scenes, "Scene files")->capture_default_str();
  app.add_option("-D,--define", settings.defines, "NAME=VALUE: a parameter of the scene files")
      ->allow_extra_args(false);
  add_positive(app, "--width", settings.width, "Film width");
  add_positive(app, "--height", settings.height, "Film height");
  add_positive(app, "--threads", settings.threads, "Worker threads");
}

void declare_picture_options(CLI::App& app, PictureSettings& settings) {
  declare_scene_options(app, settings);
  add_positive(app, "--spp", settings.samples_per_pixel, "Samples a pixel of the cache's picture");
  add_positive(app, "--reference-spp", settings.reference_samples,
               "Camera samples a pixel of each of the three references");
  app.add_option("--reference-rays", settings.reference_rays,
                 "Guided rays a pixel of each reference; 0: a path from each camera sample")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--reference-dir", settings.reference_dir, "Folder of the references")
      ->capture_default_str();
  add_positive(app, "--repeats", settings.repeats, "Seeds to take medians over");
}

SceneDescription read_scene_for(const std::string& file, const PictureSettings& settings) {
  SceneReadOptions read;
  read.width = settings.width;
  read.height = settings.height;
  for (const std::string& define : settings.defines) {
    const std::size_t equals = define.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError(define, 0, "is not of the form NAME=VALUE");
    read.defines[define.substr(0, equals)] = define.substr(equals + 1);
  }
  return read_scene(file, read);
}

RenderOptions indirect_light(Method method, int samples_per_pixel, std::uint64_t seed) {
  RenderOptions options;
  options.method = method;
  options.only = Component::kIndirect;
  options.bounces = 1;
  options.samples_per_pixel = samples_per_pixel;
  options.seed = seed;
  return options;
}

Image References::error_blocks(const Image& image) const {
  constexpr int kBlock = 8;
  const auto channel = static_cast<std::size_t>(std::ranges::find(image.channels, std::string("error.Y")) -
                                                image.channels.begin());
  VRC_CHECK(channel < image.channels.size(), "the picture has no layer error.Y");
  const Image values = scaled(rgb_of(image), scale);
  Image squares(image.width, image.height, {"error", "estimate", "noise"});
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    const auto luminance_of = [&](const Image& rgb) {
      return luminance(Eigen::Map<const Rgb>(&rgb.pixels[3 * p]));
    };
    const float a = luminance_of(images[0]), b = luminance_of(images[1]), v = luminance_of(values);
    const float estimate = scale * image.pixels[p * image.channels.size() + channel];
    squares.pixels[3 * p] = (v - a) * (v - b);
    squares.pixels[3 * p + 1] = estimate * estimate;
    squares.pixels[3 * p + 2] = 0.5f * (a - b) * (a - b);
  }
  return block_means(squares, kBlock);
}

EstimateQuality estimate_quality(const Image& error_blocks) {
  EstimateQuality result;
  for (std::size_t p = 0; p < error_blocks.pixel_count(); ++p) {
    const float* b = &error_blocks.pixels[3 * p];
    // The mean of products deviates by an eighth of this, from the noise of one reference alone.
    if (std::max(b[0], b[1]) <= b[2]) continue;
    ++result.measurable;
    if (b[0] >= 0.25f * b[1] && b[0] <= 4.0f * b[1]) ++result.within_two;
  }
  result.within_two /= std::max(result.measurable, 1.0);
  result.measurable /= static_cast<double>(error_blocks.pixel_count());
  return result;
}

double References::error_of(const Image& image) const {
  return error_of(image, PixelMask(image.pixel_count(), true));
}

double References::error_of(const Image& image, const PixelMask& mask) const {
  const Image map = two_half_error_map(scaled(rgb_of(image), scale), images[0], images[1], images[2]);
  double sum = 0.0;
  for (std::size_t p = 0; p < mask.size(); ++p) sum += mask[p] ? static_cast<double>(map.pixels[p]) : 0.0;
  return sum / static_cast<double>(std::ranges::count(mask, true));
}

References make_references(const Scene& scene, const SceneDescription& description, const std::string& file,
                           const PictureSettings& settings) {
  fs::create_directories(settings.reference_dir);
  DescriptionHash key(description);
  key.add_number(settings.reference_samples);
  key.add_number(settings.reference_rays);
  const std::string name =
      fmt::format("{}_{}x{}_{}spp_{}rays_{:016x}", fs::path(file).stem().string(), settings.width,
                  settings.height, settings.reference_samples, settings.reference_rays, key.value());
  References references;
  double mean = 0.0;
  for (std::size_t i = 0; i < references.images.size(); ++i) {
    references.images[i] =
        reference_of_seed(scene, fs::path(settings.reference_dir) / fmt::format("{}_{}.exr", name, i + 1),
                          settings, kFirstReferenceSeed + i);
    mean += mean_luminance(references.images[i]) / static_cast<double>(references.images.size());
  }
  if (!(mean > 0.0)) throw InputError(description.source, 0, "has no indirect light to compare");
  references.scale = static_cast<float>(kReferenceLuminance / mean);
  for (Image& image : references.images) image = scaled(std::move(image), references.scale);
  return references;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

int run_reported(const char* program, const PictureSettings& settings, const std::function<void()>& work) {
  try {
    set_thread_count(settings.threads);
    work();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", program, error.what());
    return 2;
  }
  return 0;
}

}  // namespace vrc::bench
