// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

#include "io/scene_reader.h"

namespace vrc {

/// A bare .obj or .ply as a scene: its own materials, a camera that frames it, a stand-in light when
/// nothing emits, one bounce (max_depth 3). Throws InputError when the mesh has no faces.
[[nodiscard]] SceneDescription read_mesh_scene(const std::filesystem::path& path,
                                               const SceneReadOptions& options);

/// Whether the file's name ends in `extension` (".obj"), in upper or lower case.
[[nodiscard]] bool has_extension(const std::filesystem::path& path, std::string_view extension);

/// Sets a camera that sees the whole scene from the front, the right and above (y is up), unless
/// `options` say otherwise, and notes it. Throws InputError when the scene has no extent.
void frame_camera(SceneDescription& scene, const SceneReadOptions& options);

/// Whether any light is in the scene.
[[nodiscard]] bool has_emitter(const SceneDescription& scene);

/// Adds a rectangular area light above the camera's left shoulder that faces the middle of the scene,
/// and a dim sky, and notes it.
void add_stand_in_light(SceneDescription& scene);

}  // namespace vrc
