// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "io/display.h"
#include "placement/baselines.h"
#include "scene_arguments.h"

namespace vrc {

/// What the user asked `vrc render` or `vrc records` to do.
struct RenderArguments : SceneArguments {
  RenderOptions render;  ///< Without what the scene decides; see `render_options_for`.
  Baseline baseline = Baseline::kNone;
  double seconds = 0.0;                  ///< > 0: that reading and rendering may take.
  std::optional<int> samples_per_pixel;  ///< Default: the scene's.

  std::vector<std::filesystem::path> images;       ///< .exr and .png
  std::vector<std::filesystem::path> record_maps;  ///< .ply, .vtp and .csv
  std::optional<std::filesystem::path> record_ellipses, record_overlay, stats;
  std::optional<std::filesystem::path> reference;
  std::optional<std::filesystem::path> camera_path;  ///< Renders a picture for each of its cameras.
  Display display;                                   ///< Of PNG files.
};

/// Declare the options of the command on `command`; parsing fills `arguments`, which must live as
/// long as `command`.
void declare_render_options(CLI::App& command, RenderArguments& arguments);
void declare_records_options(CLI::App& command, RenderArguments& arguments);

/// Throw InputError when a file cannot be written where it is wanted, has an unknown type, would
/// replace an input or another output, or when options do not go together.
void check_render_arguments(const RenderArguments& arguments);
void check_records_arguments(const RenderArguments& arguments);

/// Completes `arguments.render` by what the scene says. Throws InputError when the crop window lies
/// outside the film.
[[nodiscard]] RenderOptions render_options_for(const RenderArguments& arguments,
                                               const SceneDescription& scene);

}  // namespace vrc
