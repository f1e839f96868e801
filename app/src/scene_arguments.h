// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "io/scene_reader.h"
#include "shading/render.h"

namespace CLI {
class App;
}

namespace vrc {

/// What the commands that look at a scene through its camera have in common.
struct SceneArguments {
  std::filesystem::path scene;
  SceneReadOptions scene_options;
  double crease_angle = CreaseOptions{}.crease_angle;  ///< [degrees]
  CurvatureMethod curvature = CurvatureMethod::kFaceTensors;
  std::optional<int> bounces;  ///< Default: from the scene's max_depth.
  int threads = 0;             ///< 0: every processor.
  bool quiet = false;
};

/// Each declares a part of the options on `command`; parsing fills the targets, which must live as long
/// as `command`.
void declare_scene(CLI::App& command, SceneArguments& arguments);
/// --bounces, --size, --crop and --seed.
void declare_view(CLI::App& command, SceneArguments& arguments, std::optional<CropWindow>& crop,
                  std::uint64_t& seed);
/// --threads and --quiet.
void declare_run(CLI::App& command, SceneArguments& arguments);

/// Throws InputError when the scene is missing or cannot take the given camera.
void check_scene_arguments(const SceneArguments& arguments);

/// Prints the reader's warnings, and notes unless they are to be quiet. Throws InputError when the scene
/// cannot be used.
[[nodiscard]] SceneDescription read_scene_of(const SceneArguments& arguments);

/// Of indirect light: what was asked for, or what the scene says.
[[nodiscard]] int bounces_for(const SceneArguments& arguments, const SceneDescription& scene);

/// Throws InputError when the window reaches outside the film.
void check_crop(const std::optional<CropWindow>& crop, const Camera& camera);

}  // namespace vrc
