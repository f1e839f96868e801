// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "core/error.h"
#include "io/atomic_file.h"
#include "mesh_arguments.h"
#include "render_arguments.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error);
}

/// `what` in the plural.
void check_extension(const fs::path& path, std::string_view what,
                     std::initializer_list<std::string_view> extensions) {
  const std::string own = lower_extension(path);
  if (std::ranges::find(extensions, own) != extensions.end()) return;
  std::string list;
  for (const std::string_view e : extensions) {
    list += (list.empty() ? "" : e == *(extensions.end() - 1) ? " or " : ", ") + std::string(e);
  }
  throw InputError(path.string(), 0,
                   fmt::format("{} are written as {}; choose {}", what, list,
                               extensions.size() == 1 ? "this extension" : "one of these extensions"));
}

std::vector<fs::path> all_outputs(const RenderArguments& arguments) {
  std::vector<fs::path> outputs = arguments.images;
  outputs.insert(outputs.end(), arguments.record_maps.begin(), arguments.record_maps.end());
  for (const auto* extra : {&arguments.record_ellipses, &arguments.record_overlay, &arguments.stats}) {
    if (*extra) outputs.push_back(**extra);
  }
  return outputs;
}

void check_outputs(const RenderArguments& arguments) {
  for (const fs::path& image : arguments.images) check_extension(image, "pictures", {".exr", ".png"});
  for (const fs::path& map : arguments.record_maps) {
    check_extension(map, "record maps", {".ply", ".vtp", ".csv"});
  }
  if (arguments.record_ellipses) check_extension(*arguments.record_ellipses, "ellipses", {".ply", ".vtp"});
  if (arguments.record_overlay) check_extension(*arguments.record_overlay, "overlays", {".png"});
  const std::vector<fs::path> outputs = all_outputs(arguments);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    require_writable(outputs[i]);
    for (std::size_t k = 0; k < i; ++k) {
      if (same_file(outputs[i], outputs[k]))
        throw InputError(outputs[i].string(), 0, "is named for two outputs");
    }
    if (same_file(outputs[i], arguments.scene) ||
        (arguments.reference && same_file(outputs[i], *arguments.reference))) {
      throw InputError(outputs[i].string(), 0, "is an input of this command; write to another file");
    }
  }
}

/// Records of earlier frames must serve other cameras.
void check_camera_path(const RenderArguments& arguments) {
  const CacheOptions& cache = arguments.render.cache;
  const bool any_camera =
      arguments.baseline != Baseline::kNone ||
      (cache.strategy != Strategy::kViewDependent && cache.representation != Representation::kAnalytic);
  if (arguments.render.method != Method::kCache || !any_camera) {
    throw InputError(
        "--camera-path needs records that serve any camera: give --strategy view-independent or "
        "view-independent-outgoing, or a --baseline");
  }
  if (!cache.overture)
    throw InputError("--camera-path makes records before it shades; leave out --overture off");
  if (arguments.seconds > 0.0) throw InputError("--camera-path makes records by --error, not by --time");
  if (cache.records > 0) throw InputError("--camera-path makes records by --error, not by --records");
  if (!arguments.record_maps.empty() || arguments.record_ellipses || arguments.record_overlay ||
      arguments.reference) {
    throw InputError("--camera-path writes pictures and --stats only; leave out record maps and --reference");
  }
}

}  // namespace

void check_render_arguments(const RenderArguments& arguments) {
  const bool wants_records =
      !arguments.record_maps.empty() || arguments.record_ellipses || arguments.record_overlay;
  if (wants_records && arguments.render.method != Method::kCache) {
    throw InputError("--record-map, --record-ellipses and --record-overlay need --method cache");
  }
  if (arguments.render.path_rays > 0 && arguments.render.method != Method::kPath) {
    throw InputError("--path-rays needs --method path");
  }
  if (arguments.seconds > 0.0 && arguments.render.method != Method::kCache) {
    throw InputError("--time needs --method cache; path tracing takes --spp");
  }
  if (arguments.camera_path) check_camera_path(arguments);
  check_scene_arguments(arguments);
  check_outputs(arguments);
}

void check_records_arguments(const RenderArguments& arguments) {
  if (arguments.record_maps.empty() && !arguments.record_ellipses && !arguments.record_overlay) {
    throw InputError("give a file to write: -o for a record map, --ellipses or --overlay");
  }
  check_scene_arguments(arguments);
  check_outputs(arguments);
}

}  // namespace vrc
