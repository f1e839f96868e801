// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "io/scene_reader.h"

namespace vrc {

/// A Mitsuba scene file. Without a sensor the camera frames the scene; without any emitter the light
/// of bare meshes stands in; both are noted. Throws InputError "FILE:LINE: <element>: problem; remedy".
[[nodiscard]] SceneDescription read_mitsuba_scene(const std::filesystem::path& path,
                                                  const SceneReadOptions& options);

}  // namespace vrc
