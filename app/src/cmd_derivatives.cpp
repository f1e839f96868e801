// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "app/version.h"
#include "cli_values.h"
#include "commands.h"
#include "core/parallel.h"
#include "core/timing.h"
#include "derivatives_report.h"
#include "interrupt.h"
#include "io/atomic_file.h"
#include "io/color.h"
#include "io/image_io.h"
#include "placement/place_records.h"
#include "scene_arguments.h"
#include "scene_run.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

/// With the shares of the default step to be filled in.
constexpr const char* kFooter = R"(
At what the centre of every pixel shows, the gradient and the Hessian along the surface of the luminance
that indirect light sends towards the camera are estimated by four METHODs:
  analytic            closed forms of the gather rays, as the cache's records have them
  no-glossy-glossy    the same without the derivative of light that glossy surfaces send
  sh                  spherical harmonics of incident radiance, and of the BRDF as the point moves
  finite-differences  central differences of gathers beside the point: the reference
Written are PREFIX_METHOD_gradient and PREFIX_METHOD_hessian as .exr and .png, and PREFIX.json with the
errors against the finite differences. R, G, B hold dL/dx, dL/dy, dL/dz of the gradient and the entries xx,
yy, xy of the Hessian, both on world axes. EXR files hold the signed values. PNG files show 0 as mid-grey
(0.5), and black and white at the 99th percentile of the reference's absolute values, for all methods of a
quantity; --exposure E divides that by 2^E. A pixel where the surface ends within the step of the
differences (at creases, borders and what stands on it) is 0 in all pictures and left out of the errors.
Near other surfaces the step is limited to {:g} of the distance to the nearest hit. A larger step has less
noise, a smaller one follows sharper highlights.

Examples:
  vrc derivatives scenes/half_box.xml -o half_box --size 128x128
  vrc derivatives scenes/glossy_pair.xml -o pair --size 64x64 --gather-rays 4096 --crop 16,16,48,48
The same command gives the same pictures at any number of threads.)";

constexpr int kMostRays = 1 << 20;

struct DerivativesArguments : SceneArguments {
  std::string prefix;
  DerivativeOptions options;  ///< Without what the scene decides.
  int gather_rays = 8192;
  std::optional<int> reference_rays;
  double exposure = 0.0;
};

void declare_options(CLI::App& command, DerivativesArguments& arguments) {
  declare_scene(command, arguments);
  add_value(command, "-o,--output", "PREFIX", "Beginning of the names of the files to write", "a file name",
            [&arguments](const std::string& text) {
              arguments.prefix = text;
              return !text.empty();
            })
      ->required()
      ->group("Output");
  add_number(command, "--exposure", arguments.exposure, NumberRange<double>{-64.0, 64.0},
             "Powers of two that the values in PNG files are multiplied by")
      ->group("Output");
  declare_view(command, arguments, arguments.options.crop, arguments.options.seed);
  const auto group = [](CLI::Option* option) { option->group("Derivatives"); };
  group(add_number(command, "--gather-rays", arguments.gather_rays, NumberRange<int>{1, kMostRays},
                   "Rays of a record, rounded up to a power of two, at least 1024"));
  group(add_number(command, "--reference-rays", arguments.reference_rays, NumberRange<int>{1, kMostRays},
                   "Rays of each gather of the finite differences, rounded like these",
                   "4 times --gather-rays"));
  group(add_number(command, "--sh-order", arguments.options.harmonics_order,
                   NumberRange<int>{1, sh::kMaxFrameOrder}, "Order of spherical harmonics",
                   "by sharpness, 10 to 24"));
  group(add_number(command, "--step", arguments.options.step, NumberRange<double>{1e-3, 1e3},
                   "Step of the finite differences, in pixels",
                   fmt::format("{:g} of the film's width", DerivativeOptions::kStepShare)));
  declare_run(command, arguments);
  command.footer(fmt::format(kFooter, DerivativeOptions::kNearestShare));
}

/// Name of the file with a method's quantity.
fs::path picture_path(const std::string& prefix, DerivativeMethod method, const char* quantity,
                      const char* extension) {
  return fmt::format("{}_{}_{}{}", prefix, name_of(method), quantity, extension);
}

constexpr const char* kQuantities[] = {"gradient", "hessian"};

void check_outputs(const DerivativesArguments& arguments) {
  require_writable(arguments.prefix + ".json");
  for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
    for (const char* quantity : kQuantities) {
      for (const char* extension : {".exr", ".png"}) {
        require_writable(
            picture_path(arguments.prefix, static_cast<DerivativeMethod>(m), quantity, extension));
      }
    }
  }
}

/// Signed values as linear colours: 0 becomes the grey that PNG files hold as 0.5, -scale and below black,
/// scale and above white.
Image signed_colors(const Image& image, double scale) {
  Image colors = image;
  for (float& v : colors.pixels) {
    const double share = scale > 0.0 ? static_cast<double>(v) / scale : 0.0;
    v = linear_from_srgb(static_cast<float>(0.5 + 0.5 * std::clamp(share, -1.0, 1.0)));
  }
  return colors;
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
      return picture_path(arguments.prefix, method, quantity, extension);
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

int run_derivatives(const DerivativesArguments& arguments, const std::string& command_line) {
  const PhaseTimer total("total");
  check_scene_arguments(arguments);
  check_outputs(arguments);
  const InterruptGuard interrupt;
  DerivativesReport report;
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
  options.log2_reference_rays =
      log2_rays_for(arguments.reference_rays.value_or(std::min(4 * arguments.gather_rays, kMostRays)));

  const Scene scene(description);
  DerivativeImages images;
  with_progress(arguments.quiet, interrupt.flag(),
                [&](const RunControl& control) { images = estimate_derivatives(scene, options, control); });
  report.gradient_scale = write_pictures(arguments, images, kQuantities[0], gradient_image);
  report.hessian_scale = write_pictures(arguments, images, kQuantities[1], hessian_image);
  report.seconds = total.elapsed().seconds;
  report.cpu_seconds = process_cpu_seconds();
  write_file_atomically(arguments.prefix + ".json", derivatives_json(report, images));
  std::cout << derivatives_table(images)
            << fmt::format("{:.2f} s, {:.2f} CPU s, {} of {} pixels, step {:g} pixels, SH order {}\n",
                           report.seconds, report.cpu_seconds, images.valid_count(), images.valid.size(),
                           images.step, images.harmonics_order)
            << std::flush;
  return kExitDone;
}

}  // namespace

CommandAction add_derivatives_command(CLI::App& program, const std::string& command_line) {
  CLI::App* command = program.add_subcommand(
      "derivatives", "Draw the gradient and Hessian of radiance at every pixel, by four methods");
  const auto arguments = std::make_shared<DerivativesArguments>();
  declare_options(*command, *arguments);
  return [arguments, command_line] { return run_derivatives(*arguments, command_line); };
}

}  // namespace vrc
