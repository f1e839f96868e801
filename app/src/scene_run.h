// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <memory>

#include "core/error.h"
#include "render_arguments.h"
#include "stats_json.h"

namespace vrc {

/// A scene that was read and rendered.
struct SceneRun {
  std::shared_ptr<const Scene> scene;  ///< The result's cache refers to it.
  RenderResult result;
  RunReport report;
};

/// Does `work` with its progress shown on standard error.
void with_progress(bool quiet, const std::atomic<bool>& stop,
                   const std::function<void(const RunControl&)>& work);

/// Reads and renders the scene of the arguments, showing progress. `check` sees the scene before the
/// work begins and may throw. Throws Interrupted when `stop` is raised before it begins.
[[nodiscard]] SceneRun run_scene(const RenderArguments& arguments, const std::string& command_line,
                                 const std::atomic<bool>& stop,
                                 const std::function<void(const SceneDescription&)>& check);

/// Renders the frames of `arguments.camera_path`, each from the records of those before it, and hands
/// them to `finish` in order. Stops after the frame in which `stop` is raised. Throws as run_scene does.
void run_frames(const RenderArguments& arguments, const std::string& command_line,
                const std::atomic<bool>& stop,
                const std::function<void(std::size_t frame, const SceneRun&)>& finish);

/// Runs several writers: one that fails does not keep the others from writing.
class OutputErrors {
 public:
  template <typename Write>
  void attempt(const Write& write) {
    try {
      write();
    } catch (const InputError&) {
      if (!first_) first_ = std::current_exception();
    }
  }
  void rethrow_first() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::exception_ptr first_;
};

/// Writes the record maps, ellipses and the overlay that the arguments ask for.
void write_record_files(const RenderArguments& arguments, const RenderResult& result, OutputErrors& errors);

/// Completes the report by the time for `writing` the files and since the start of `total`, writes the
/// statistics, prints the summary and returns the exit code.
int finish_run(const RenderArguments& arguments, SceneRun& run, const PhaseTimer& writing,
               const PhaseTimer& total);

}  // namespace vrc
