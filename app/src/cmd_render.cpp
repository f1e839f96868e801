// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "commands.h"
#include "core/image_error.h"
#include "interrupt.h"
#include "io/atomic_file.h"
#include "io/image_io.h"
#include "picture_file.h"
#include "render_arguments.h"
#include "scene_run.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

std::optional<Image> read_reference(const std::optional<fs::path>& path) {
  if (!path) return std::nullopt;
  Image reference = read_image(*path);
  try {
    static_cast<void>(compare_rgb(reference, reference));
  } catch (const InputError& error) {  // no R, G and B
    throw InputError(path->string(), 0, error.what());
  }
  return reference;
}

void check_reference_size(const fs::path& path, const Image& reference, const Camera& camera) {
  if (reference.width == camera.width && reference.height == camera.height) return;
  throw InputError(path.string(), 0,
                   fmt::format("is {}x{} pixels and the film {}x{}; give a reference of the film's size",
                               reference.width, reference.height, camera.width, camera.height));
}

double relmse_to(const Image& reference, const Image& image, const std::optional<CropWindow>& window) {
  if (!window) return compare_rgb(image, reference).relmse;
  const auto cut = [&](const Image& whole) {
    return crop(whole, window->x0, window->y0, window->x1, window->y1);
  };
  return compare_rgb(cut(image), cut(reference)).relmse;
}

int run_render(const RenderArguments& arguments, const std::string& command_line) {
  const PhaseTimer total("total");
  check_render_arguments(arguments);
  const std::optional<Image> reference = read_reference(arguments.reference);
  const InterruptGuard interrupt;
  SceneRun run = run_scene(arguments, command_line, interrupt.flag(), [&](const SceneDescription& scene) {
    if (reference) check_reference_size(*arguments.reference, *reference, scene.camera);
  });
  const Image& image = run.result.image;
  if (reference) run.report.relmse = relmse_to(*reference, image, run.report.options.crop);

  const PhaseTimer writing("write files");
  OutputErrors errors;
  for (const fs::path& path : arguments.images) {
    errors.attempt([&] { write_picture(path, image, arguments.display, run.report); });
  }
  write_record_files(arguments, run.result, errors);
  errors.rethrow_first();
  return finish_run(arguments, run, writing, total);
}

/// a/b.exr as a/b_0012.exr.
fs::path frame_path(const fs::path& path, std::size_t frame) {
  return path.parent_path() /
         fmt::format("{}_{:04}{}", path.stem().string(), frame, path.extension().string());
}

int run_fly_through(const RenderArguments& arguments, const std::string& command_line) {
  check_render_arguments(arguments);
  const InterruptGuard interrupt;
  std::vector<RunReport> reports;
  double cpu_before = 0.0;
  const auto write = [&](std::size_t frame, const SceneRun& run) {
    OutputErrors errors;
    for (const fs::path& path : arguments.images) {
      errors.attempt(
          [&] { write_picture(frame_path(path, frame), run.result.image, arguments.display, run.report); });
    }
    errors.rethrow_first();
    reports.push_back(run.report);
    RunReport& report = reports.back();
    for (const PhaseTime& phase : report.stats.phases) report.seconds += phase.seconds;
    const double cpu = process_cpu_seconds();
    report.cpu_seconds = cpu - cpu_before;
    cpu_before = cpu;
    std::cout << fmt::format("frame {}: {} records made, {}", frame, report.stats.records_made,
                             summary_line(report))
              << std::endl;
  };
  run_frames(arguments, command_line, interrupt.flag(), write);
  if (arguments.stats) write_file_atomically(*arguments.stats, frames_json(reports));
  if (!interrupt.flag()) return kExitDone;
  std::cerr << "vrc: interrupted: the last frame is unfinished\n";
  return kExitInterrupted;
}

}  // namespace

CommandAction add_render_command(CLI::App& program, const std::string& command_line) {
  CLI::App* command = program.add_subcommand("render", "Render a scene to EXR and PNG files");
  const auto arguments = std::make_shared<RenderArguments>();
  declare_render_options(*command, *arguments);
  return [arguments, command_line] {
    return arguments->camera_path ? run_fly_through(*arguments, command_line)
                                  : run_render(*arguments, command_line);
  };
}

}  // namespace vrc
