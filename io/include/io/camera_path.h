// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "transport/camera.h"

namespace vrc {

/// The cameras of a fly-through, one a line: where the camera stands, what it looks at and, if the last
/// three numbers are given, what is up: `ox oy oz  tx ty tz  [ux uy uz]` in world units. `#` begins a
/// comment. Field of view, film and the default of up are those of `lens`. Throws InputError with file
/// and line for anything else, and for a file without cameras.
[[nodiscard]] std::vector<Camera> read_camera_path(const std::filesystem::path& path, const Camera& lens);

}  // namespace vrc
