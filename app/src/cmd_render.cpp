// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <chrono>
#include <exception>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "app/progress.h"
#include "app/version.h"
#include "commands.h"
#include "core/image_error.h"
#include "core/parallel.h"
#include "interrupt.h"
#include "io/atomic_file.h"
#include "io/image_io.h"
#include "record_entries.h"
#include "render_arguments.h"
#include "stats_json.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void print_messages(const SceneDescription& scene, bool quiet) {
  for (const std::string& warning : scene.warnings) std::cerr << "warning: " << warning << "\n";
  if (quiet) return;
  for (const std::string& note : scene.notes) std::cerr << "note: " << note << "\n";
}

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

RenderResult render_with_progress(const Scene& scene, const RenderOptions& options, bool quiet,
                                  const std::atomic<bool>& stop) {
  ProgressDisplay display(std::cerr, quiet ? ProgressStyle::kNone : progress_style_of_stderr(),
                          steady_seconds, terminal_columns());
  RunControl control;
  control.progress = [&display](const ProgressUpdate& update) { display.update(update); };
  control.stop = &stop;
  return render(scene, options, control);
}

/// Where the picture comes from. The pixels do not depend on threads or time; this header may.
ImageMetadata metadata_of(const RunReport& report) {
  ImageMetadata metadata{
      {"vrc:version", std::string(kVersion)},
      {"vrc:scene", report.scene},
      {"vrc:command_line", report.command_line},
      {"vrc:seconds", fmt::format("{:.3f}", report.render_seconds)},
      {"vrc:method", std::string(name_of(report.options.method))},
      {"vrc:only", std::string(name_of(report.options.only))},
      {"vrc:bounces", std::to_string(report.options.bounces)},
      {"vrc:spp", std::to_string(report.options.samples_per_pixel)},
      {"vrc:seed", std::to_string(report.options.seed)},
  };
  if (report.options.method == Method::kCache) {
    metadata["vrc:error"] = fmt::format("{}", report.options.cache.error);
    metadata["vrc:records"] = std::to_string(report.stats.records);
  }
  if (report.stats.unfinished) metadata["vrc:unfinished"] = "true";
  return metadata;
}

void write_picture(const fs::path& path, const Image& image, double exposure, const RunReport& report) {
  if (path.extension() == ".png" || path.extension() == ".PNG") {
    write_png(path, image, exposure);
  } else {
    write_exr(path, image, metadata_of(report));
  }
}

/// Writes all outputs but the statistics. One that fails does not keep the others from being written;
/// its error is thrown at the end.
void write_outputs(const RenderArguments& arguments, const RenderResult& result, const RunReport& report) {
  std::exception_ptr first_error;
  const auto attempt = [&first_error](const auto& write) {
    try {
      write();
    } catch (const InputError&) {
      if (!first_error) first_error = std::current_exception();
    }
  };
  for (const fs::path& path : arguments.images) {
    attempt([&] { write_picture(path, result.image, arguments.exposure, report); });
  }
  if (arguments.record_map || arguments.record_ellipses) {
    const std::vector<RecordMapEntry> entries =
        result.cache ? record_entries(*result.cache) : std::vector<RecordMapEntry>{};
    if (arguments.record_map) attempt([&] { write_record_map(*arguments.record_map, entries); });
    if (arguments.record_ellipses)
      attempt([&] { write_record_ellipses(*arguments.record_ellipses, entries); });
  }
  if (first_error) std::rethrow_exception(first_error);
}

int run_render(const RenderArguments& arguments, const std::string& command_line) {
  const PhaseTimer total("total");
  check_render_arguments(arguments);
  const std::optional<Image> reference = read_reference(arguments.reference);
  const InterruptGuard interrupt;
  RunReport report;
  report.scene = arguments.scene.string();
  report.command_line = command_line;
  report.threads = set_thread_count(arguments.threads);

  const PhaseTimer reading("read scene");
  const SceneDescription description = read_scene(arguments.scene, arguments.scene_options);
  print_messages(description, arguments.quiet);
  report.options = render_options_for(arguments, description);
  report.width = description.camera.width;
  report.height = description.camera.height;
  if (reference) check_reference_size(*arguments.reference, *reference, description.camera);
  const PhaseTime reading_time = reading.elapsed();
  const PhaseTimer building("build scene");
  const Scene scene(description);
  const PhaseTime building_time = building.elapsed();
  if (interrupt.flag()) throw Interrupted();

  const PhaseTimer rendering("render");
  const RenderResult result = render_with_progress(scene, report.options, arguments.quiet, interrupt.flag());
  report.render_seconds = rendering.elapsed().seconds;
  report.stats = result.stats;
  if (reference) report.relmse = relmse_to(*reference, result.image, report.options.crop);

  const PhaseTimer writing("write files");
  write_outputs(arguments, result, report);
  auto& phases = report.stats.phases;
  phases.insert(phases.begin(), {reading_time, building_time});
  phases.push_back(writing.elapsed());
  report.seconds = total.elapsed().seconds;
  report.cpu_seconds = process_cpu_seconds();
  if (arguments.stats) write_file_atomically(*arguments.stats, stats_json(report));
  std::cout << summary_line(report) << std::endl;
  if (!report.stats.unfinished) return kExitDone;
  std::cerr << "vrc: interrupted: the files hold an unfinished picture\n";
  return kExitInterrupted;
}

}  // namespace

CommandAction add_render_command(CLI::App& program, const std::string& command_line) {
  CLI::App* command = program.add_subcommand("render", "Render a scene to EXR and PNG files");
  const auto arguments = std::make_shared<RenderArguments>();
  declare_render_options(*command, *arguments);
  return [arguments, command_line] { return run_render(*arguments, command_line); };
}

}  // namespace vrc
