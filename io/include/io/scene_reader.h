// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "transport/scene_description.h"

namespace vrc {

struct SceneReadOptions {
  std::map<std::string, std::string> defines;  ///< -D name=value: overrides <default>.
  bool lenient = false;                        ///< Turn what is not understood into warnings.

  // Only for bare meshes, which have no camera of their own:
  std::optional<Vec3> camera_origin;
  std::optional<Vec3> camera_target;
  std::optional<double> fov_degrees;
  std::optional<int> width, height;  ///< Film size, also over that of a scene file.
};

/// Reads a Mitsuba 3 scene (.xml), or a bare mesh (.obj, .ply), chosen by the file's extension.
/// Throws InputError naming file, line and element.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& path,
                                          const SceneReadOptions& options = {});

}  // namespace vrc
