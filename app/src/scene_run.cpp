// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_run.h"

#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "app/command_line.h"
#include "app/progress.h"
#include "core/parallel.h"
#include "io/atomic_file.h"
#include "io/camera_path.h"
#include "io/image_io.h"
#include "record_entries.h"
#include "shading/record_overlay.h"

namespace vrc {
namespace {

constexpr double kLate = 1.05;  // times the time that was given, from which on that is told

/// Without a cache, the picture alone.
void write_overlay(const std::filesystem::path& path, const RenderResult& result, const Display& display) {
  if (!result.cache) return write_png(path, result.image, display);
  write_png(path, draw_record_overlay(displayed(result.image, display), *result.cache));
}

/// Reads the scene and starts the report. The scene is not const: a fly-through moves its camera.
struct LoadedScene {
  std::unique_ptr<Scene> scene;
  RunReport report;
};

LoadedScene load_scene(const RenderArguments& arguments, const std::string& command_line,
                       const std::atomic<bool>& stop,
                       const std::function<void(const SceneDescription&)>& check) {
  LoadedScene loaded;
  RunReport& report = loaded.report;
  report.scene = arguments.scene.string();
  report.command_line = command_line;
  report.threads = set_thread_count(arguments.threads);

  const PhaseTimer reading("read scene");
  const SceneDescription description = read_scene_of(arguments);
  report.options = render_options_for(arguments, description);
  report.width = description.camera.width;
  report.height = description.camera.height;
  check(description);
  report.stats.phases.push_back(reading.elapsed());
  const PhaseTimer building("build scene");
  loaded.scene = std::make_unique<Scene>(description);
  report.stats.phases.push_back(building.elapsed());
  if (stop) throw Interrupted();
  return loaded;
}

/// Renders and completes the report, whose phases so far are kept.
RenderResult render_reported(const Scene& scene, bool quiet, const std::atomic<bool>& stop,
                             const EarlierFrames& earlier, RunReport& report) {
  const PhaseTimer rendering("render");
  RenderResult result;
  if (report.options.seconds > 0.0) {
    // Reading and building have taken a part.
    for (const PhaseTime& phase : report.stats.phases) report.options.seconds -= phase.seconds;
    report.options.seconds = std::max(report.options.seconds, 1e-3);
  }
  with_progress(quiet, stop,
                [&](const RunControl& control) { result = render(scene, report.options, control, earlier); });
  report.render_seconds = rendering.elapsed().seconds;
  std::vector<PhaseTime> phases = std::move(report.stats.phases);
  report.stats = result.stats;
  report.stats.phases.insert(report.stats.phases.begin(), phases.begin(), phases.end());
  if (result.cache) report.classes = count_classes(result.cache->records());
  return result;
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
  LoadedScene loaded = load_scene(arguments, command_line, stop, check);
  SceneRun run;
  run.report = std::move(loaded.report);
  run.scene = std::move(loaded.scene);
  run.result = render_reported(*run.scene, arguments.quiet, stop, {}, run.report);
  return run;
}

void run_frames(const RenderArguments& arguments, const std::string& command_line,
                const std::atomic<bool>& stop,
                const std::function<void(std::size_t frame, const SceneRun&)>& finish) {
  std::vector<Camera> cameras;
  LoadedScene loaded = load_scene(arguments, command_line, stop, [&](const SceneDescription& scene) {
    cameras = read_camera_path(*arguments.camera_path, scene.camera);
  });
  const std::shared_ptr<Scene> scene = std::move(loaded.scene);
  SceneRun run;
  run.scene = scene;
  for (std::size_t frame = 0; frame < cameras.size() && !stop; ++frame) {
    scene->look_through(cameras[frame]);
    const RenderResult before = std::move(run.result);
    const EarlierFrames earlier = {before.cache ? &*before.cache : nullptr, before.scale};
    run.report = loaded.report;
    run.result = render_reported(*scene, arguments.quiet, stop, earlier, run.report);
    finish(frame, run);
    loaded.report.stats.phases.clear();  // reading and building are reported with the first frame
  }
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
    errors.attempt([&] { write_overlay(*arguments.record_overlay, result, arguments.display); });
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
  const double taken = report.seconds - report.stats.phases.back().seconds;
  if (arguments.seconds > 0.0 && taken > kLate * arguments.seconds && !arguments.quiet) {
    std::cerr << fmt::format(
        "vrc: note: --time {:g} is less than this picture takes, which was {:.1f} s; give fewer --spp or a "
        "smaller --size\n",
        arguments.seconds, taken);
  }
  if (!report.stats.unfinished) return kExitDone;
  std::cerr << "vrc: interrupted: the files are unfinished\n";
  return kExitInterrupted;
}

}  // namespace vrc
