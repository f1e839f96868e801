// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scene_reader.h"

#include "core/error.h"
#include "mesh_scene.h"
#include "mitsuba_scene.h"

namespace vrc {
namespace {

void check_film_option(std::optional<int> size, const char* name) {
  constexpr int kMaxFilmSize = 65536;
  if (size && (*size < 1 || *size > kMaxFilmSize)) {
    throw InputError(fmt::format("{} {}: a film is 1 to {} pixels wide and high", name, *size, kMaxFilmSize));
  }
}

}  // namespace

SceneDescription read_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
  check_film_option(options.width, "width");
  check_film_option(options.height, "height");
  const bool is_xml = has_extension(path, ".xml");
  if (!is_xml && !has_extension(path, ".obj") && !has_extension(path, ".ply")) {
    throw InputError(path.string(), 0, "not a known kind of scene; give an .xml, .obj or .ply file");
  }
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(path.string(), 0, "there is no such file; check the name");
  }
  return is_xml ? read_mitsuba_scene(path, options) : read_mesh_scene(path, options);
}

}  // namespace vrc
