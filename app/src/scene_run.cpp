// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_run.h"

#include <chrono>
#include <iostream>

#include "app/command_line.h"
#include "app/progress.h"
#include "core/parallel.h"
#include "io/atomic_file.h"
#include "io/image_io.h"
#include "record_entries.h"
#include "shading/record_overlay.h"

namespace vrc {
namespace {

/// Without a cache, the picture alone.
void write_overlay(const std::filesystem::path& path, const RenderResult& result, double exposure) {
  if (!result.cache) return write_png(path, result.image, exposure);
  RecordOverlayOptions options;
  options.exposure = exposure;
  write_png(path, draw_record_overlay(result.image, *result.cache, options));
}

}  // namespace

void with_progress(bool quiet, const std::atomic<bool>& stop,
                   const std::function<void(const RunControl&)>& work) {
  const auto steady_seconds = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  ProgressDisplay display(std::cerr, quiet ? ProgressStyle::kNone : progress_style_of_stderr(),
                          steady_seconds, terminal_columns());
  RunControl control;
  control.progress = [&display](const ProgressUpdate& update) { display.update(update); };
  control.stop = &stop;
  work(control);
}

SceneRun run_scene(const RenderArguments& arguments, const std::string& command_line,
                   const std::atomic<bool>& stop, const std::function<void(const SceneDescription&)>& check) {
  SceneRun run;
  RunReport& report = run.report;
  report.scene = arguments.scene.string();
  report.command_line = command_line;
  report.threads = set_thread_count(arguments.threads);

  const PhaseTimer reading("read scene");
  const SceneDescription description = read_scene_of(arguments);
  report.options = render_options_for(arguments, description);
  report.width = description.camera.width;
  report.height = description.camera.height;
  check(description);
  const PhaseTime reading_time = reading.elapsed();
  const PhaseTimer building("build scene");
  run.scene = std::make_unique<const Scene>(description);
  const PhaseTime building_time = building.elapsed();
  if (stop) throw Interrupted();

  const PhaseTimer rendering("render");
  with_progress(arguments.quiet, stop,
                [&](const RunControl& control) { run.result = render(*run.scene, report.options, control); });
  report.render_seconds = rendering.elapsed().seconds;
  report.stats = run.result.stats;
  if (run.result.cache) report.classes = count_classes(run.result.cache->records());
  auto& phases = report.stats.phases;
  phases.insert(phases.begin(), {reading_time, building_time});
  return run;
}

void write_record_files(const RenderArguments& arguments, const RenderResult& result, OutputErrors& errors) {
  if (!arguments.record_maps.empty() || arguments.record_ellipses) {
    const std::vector<RecordMapEntry> entries =
        result.cache ? record_entries(*result.cache) : std::vector<RecordMapEntry>{};
    if (!arguments.record_maps.empty()) {
      const SurfaceExport map = record_map(entries);
      for (const auto& path : arguments.record_maps) errors.attempt([&] { write_surface(path, map); });
    }
    if (arguments.record_ellipses) {
      const std::vector<EllipseTessellation> ellipses =
          result.cache ? record_tessellations(*result.cache) : std::vector<EllipseTessellation>{};
      errors.attempt([&] { write_surface(*arguments.record_ellipses, record_ellipses(entries, ellipses)); });
    }
  }
  if (arguments.record_overlay) {
    errors.attempt([&] { write_overlay(*arguments.record_overlay, result, arguments.exposure); });
  }
}

int finish_run(const RenderArguments& arguments, SceneRun& run, const PhaseTimer& writing,
               const PhaseTimer& total) {
  RunReport& report = run.report;
  report.stats.phases.push_back(writing.elapsed());
  report.seconds = total.elapsed().seconds;
  report.cpu_seconds = process_cpu_seconds();
  if (arguments.stats) write_file_atomically(*arguments.stats, stats_json(report));
  std::cout << summary_line(report) << std::endl;
  if (!report.stats.unfinished) return kExitDone;
  std::cerr << "vrc: interrupted: the files are unfinished\n";
  return kExitInterrupted;
}

}  // namespace vrc
