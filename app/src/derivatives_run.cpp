// SPDX-License-Identifier: GPL-3.0-or-later
#include "derivatives_run.h"

#include <algorithm>
#include <cmath>

#include "app/version.h"
#include "core/parallel.h"
#include "core/timing.h"
#include "io/atomic_file.h"
#include "io/color.h"
#include "io/image_io.h"
#include "placement/place_records.h"
#include "scene_run.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

constexpr const char* kQuantities[] = {"gradient", "hessian"};

void check_outputs(const DerivativesArguments& arguments) {
  require_writable(arguments.prefix + ".json");
  for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
    for (const char* quantity : kQuantities) {
      for (const char* extension : {".exr", ".png"}) {
        require_writable(derivative_picture_path(arguments.prefix, name_of(static_cast<DerivativeMethod>(m)),
                                                 quantity, extension));
      }
    }
  }
}

/// Writes one quantity of all methods; returns the value that is white.
template <typename ImageOf>
double write_pictures(const DerivativesArguments& arguments, const DerivativeImages& images,
                      const char* quantity, const ImageOf& image_of) {
  const double scale = robust_scale(images, image_of(images, DerivativeMethod::kFiniteDifferences));
  for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
    const auto method = static_cast<DerivativeMethod>(m);
    const Image image = image_of(images, method);
    const auto path = [&](const char* extension) {
      return derivative_picture_path(arguments.prefix, name_of(method), quantity, extension);
    };
    write_exr(path(".exr"), image,
              {{"vrc:version", std::string(kVersion)},
               {"vrc:scene", arguments.scene.string()},
               {"vrc:method", std::string(name_of(method))},
               {"vrc:quantity", quantity}});
    write_png(path(".png"), signed_colors(image, scale * std::exp2(-arguments.exposure)));
  }
  return scale;
}

}  // namespace

fs::path derivative_picture_path(const std::string& prefix, std::string_view method,
                                 std::string_view quantity, std::string_view extension) {
  return fmt::format("{}_{}_{}{}", prefix, method, quantity, extension);
}

Image signed_colors(const Image& image, double scale) {
  Image colors = image;
  for (float& v : colors.pixels) {
    const double share = scale > 0.0 ? static_cast<double>(v) / scale : 0.0;
    v = linear_from_srgb(static_cast<float>(0.5 + 0.5 * std::clamp(share, -1.0, 1.0)));
  }
  return colors;
}

DerivativesRun run_derivatives(const DerivativesArguments& arguments, const std::string& command_line,
                               const std::atomic<bool>& stop) {
  const PhaseTimer total("total");
  check_scene_arguments(arguments);
  check_outputs(arguments);
  DerivativesRun run;
  DerivativesReport& report = run.report;
  report.scene = arguments.scene.string();
  report.command_line = command_line;
  report.threads = set_thread_count(arguments.threads);
  const SceneDescription description = read_scene_of(arguments);
  check_crop(arguments.options.crop, description.camera);
  DerivativeOptions& options = report.options = arguments.options;
  options.bounces = bounces_for(arguments, description);
  if (options.bounces == 0) {
    throw InputError("without indirect light there are no derivatives; give --bounces 1 or more");
  }
  options.log2_rays = log2_rays_for(arguments.gather_rays);
  options.log2_reference_rays = log2_rays_for(
      arguments.reference_rays.value_or(std::min(4 * arguments.gather_rays, kMostDerivativeRays)));

  const Scene scene(description);
  DerivativeImages& images = run.images;
  with_progress(arguments.quiet, stop,
                [&](const RunControl& control) { images = estimate_derivatives(scene, options, control); });
  report.gradient_scale = write_pictures(arguments, images, kQuantities[0], gradient_image);
  report.hessian_scale = write_pictures(arguments, images, kQuantities[1], hessian_image);
  report.seconds = total.elapsed().seconds;
  report.cpu_seconds = process_cpu_seconds();
  write_file_atomically(arguments.prefix + ".json", derivatives_json(report, images));
  return run;
}

}  // namespace vrc
