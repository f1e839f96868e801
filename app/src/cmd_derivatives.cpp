// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "cli_values.h"
#include "commands.h"
#include "derivatives_run.h"
#include "interrupt.h"

namespace vrc {
namespace {

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

int run_command(const DerivativesArguments& arguments, const std::string& command_line) {
  const InterruptGuard interrupt;
  const DerivativesRun run = run_derivatives(arguments, command_line, interrupt.flag());
  const DerivativeImages& images = run.images;
  std::cout << derivatives_table(images)
            << fmt::format("{:.2f} s, {:.2f} CPU s, {} of {} pixels, step {:g} pixels, SH order {}\n",
                           run.report.seconds, run.report.cpu_seconds, images.valid_count(),
                           images.valid.size(), images.step, images.harmonics_order)
            << std::flush;
  return kExitDone;
}

}  // namespace

void declare_derivatives_options(CLI::App& command, DerivativesArguments& arguments) {
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
  group(add_number(command, "--gather-rays", arguments.gather_rays, NumberRange<int>{1, kMostDerivativeRays},
                   "Rays of a record, rounded up to a power of two, at least 1024"));
  group(add_number(
      command, "--reference-rays", arguments.reference_rays, NumberRange<int>{1, kMostDerivativeRays},
      "Rays of each gather of the finite differences, rounded like these", "4 times --gather-rays"));
  group(add_number(command, "--sh-order", arguments.options.harmonics_order,
                   NumberRange<int>{1, sh::kMaxFrameOrder}, "Order of spherical harmonics",
                   "by sharpness, 10 to 24"));
  group(add_number(command, "--step", arguments.options.step, NumberRange<double>{1e-3, 1e3},
                   "Step of the finite differences, in pixels",
                   fmt::format("{:g} of the film's width", DerivativeOptions::kStepShare)));
  declare_run(command, arguments);
  command.footer(fmt::format(kFooter, DerivativeOptions::kNearestShare));
}

CommandAction add_derivatives_command(CLI::App& program, const std::string& command_line) {
  CLI::App* command = program.add_subcommand(
      "derivatives", "Draw the gradient and Hessian of radiance at every pixel, by four methods");
  const auto arguments = std::make_shared<DerivativesArguments>();
  declare_derivatives_options(*command, *arguments);
  return [arguments, command_line] { return run_command(*arguments, command_line); };
}

}  // namespace vrc
