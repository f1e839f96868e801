// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "figure.h"
#include "scene_run.h"

namespace vrc {

/// CPU seconds of rendering alone, without files and the scene.
[[nodiscard]] double render_cpu_seconds(const RenderResult& result);

struct TimedRun {
  SceneRun run;
  int number = 0;  ///< Of the option.
};

/// Looks for the number of the option with which `render` takes about so many CPU seconds, and returns the
/// run of it that came closest.
[[nodiscard]] TimedRun run_for_time(const EqualTime& equal, double cpu_seconds,
                                    const std::function<SceneRun(int number)>& render);

}  // namespace vrc
