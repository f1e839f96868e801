// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_arguments.h"

#include <algorithm>
#include <iostream>
#include <limits>

#include "cli_values.h"
#include "core/error.h"
#include "mesh_arguments.h"

namespace vrc {

void declare_scene(CLI::App& command, SceneArguments& arguments) {
  SceneReadOptions& scene = arguments.scene_options;
  command.add_option("scene", arguments.scene, "Mitsuba 3 scene (.xml) or bare mesh (.obj, .ply)")
      ->type_name("SCENE")
      ->required();
  const auto add_point = [&](const char* name, std::optional<Vec3>& target, const char* description) {
    add_value(command, name, "x,y,z", description, "three numbers x,y,z", [&target](const std::string& text) {
      return (target = parse_vec3(text)).has_value();
    })->group("Scene");
  };
  command
      .add_option_function<std::vector<std::string>>(
          "-D,--define",
          [&scene](const std::vector<std::string>& definitions) {
            for (const std::string& text : definitions) {
              const std::size_t equals = text.find('=');
              if (equals == 0 || equals == std::string::npos) {
                throw CLI::ValidationError("--define",
                                           fmt::format("'{}' is not of the form NAME=VALUE", text));
              }
              scene.defines[text.substr(0, equals)] = text.substr(equals + 1);
            }
          },
          "Set a parameter of the scene file; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->group("Scene");
  add_number(command, "--crease-angle", arguments.crease_angle, NumberRange<double>{0.0, 180.0},
             "Edges that bend by more are creases, in degrees; supplied normals go before")
      ->group("Scene");
  add_choice(command, "--curvature", arguments.curvature,
             {{"tensor", CurvatureMethod::kFaceTensors}, {"jet", CurvatureMethod::kJet}},
             "How the curvature of surfaces is estimated")
      ->group("Scene");
  command.add_flag("--lenient", scene.lenient, "Warn about what is not understood instead of stopping")
      ->group("Scene");
  add_point("--camera-origin", scene.camera_origin, "Where the camera of a bare mesh stands");
  add_point("--camera-target", scene.camera_target, "What the camera of a bare mesh looks at");
  add_number(command, "--fov", scene.fov_degrees, NumberRange<double>{0.01, 179.0},
             "Horizontal field of view for a bare mesh, in degrees")
      ->group("Scene");
}

void declare_run(CLI::App& command, SceneArguments& arguments) {
  add_number(command, "--threads", arguments.threads, NumberRange<int>{1, 1024},
             "Worker threads; the files do not depend on them", "one for each processor")
      ->group("Run");
  command.add_flag("--quiet", arguments.quiet, "No progress and no notes")->group("Run");
}

void declare_view(CLI::App& command, SceneArguments& arguments, std::optional<CropWindow>& crop,
                  std::uint64_t& seed) {
  const auto group = [](CLI::Option* option) { option->group("Picture"); };
  group(add_number(command, "--bounces", arguments.bounces, NumberRange<int>{-1, 1024},
                   "Indirect bounces; 0 is direct light only, -1 is unbounded", "the scene's max_depth - 2"));
  group(add_value(command, "--size", "WxH", "Film size in pixels",
                  "a size such as 640x480, at most 16384x16384",
                  [&arguments](const std::string& text) {
                    const auto size = parse_size(text);
                    if (!size) return false;
                    arguments.scene_options.width = size->first;
                    arguments.scene_options.height = size->second;
                    return true;
                  })
            ->default_str("the scene's"));
  group(add_value(command, "--crop", "x0,y0,x1,y1",
                  "Render only these pixels, x1 and y1 excluded; others stay black",
                  "four whole numbers x0,y0,x1,y1 with 0 <= x0 < x1 and 0 <= y0 < y1",
                  [&crop](const std::string& text) { return (crop = parse_crop(text)).has_value(); }));
  group(add_number(command, "--seed", seed,
                   NumberRange<std::uint64_t>{0, std::numeric_limits<std::uint64_t>::max()},
                   "Another seed gives other noise"));
}

void check_scene_arguments(const SceneArguments& arguments) {
  const SceneReadOptions& scene = arguments.scene_options;
  if ((scene.camera_origin || scene.camera_target || scene.fov_degrees) &&
      lower_extension(arguments.scene) == ".xml") {
    throw InputError(
        "--camera-origin, --camera-target and --fov are for bare meshes; edit the <sensor> of the scene, or "
        "use -D with a parameter of it");
  }
  std::error_code error;
  if (!std::filesystem::exists(arguments.scene, error)) {
    throw InputError(arguments.scene.string(), 0, "no such file");
  }
}

SceneDescription read_scene_of(const SceneArguments& arguments) {
  SceneDescription scene = read_scene(arguments.scene, arguments.scene_options);
  scene.crease_angle = arguments.crease_angle;
  scene.curvature = arguments.curvature;
  for (const std::string& warning : scene.warnings) std::cerr << "warning: " << warning << "\n";
  if (!arguments.quiet) {
    for (const std::string& note : scene.notes) std::cerr << "note: " << note << "\n";
  }
  return scene;
}

int bounces_for(const SceneArguments& arguments, const SceneDescription& scene) {
  const int scene_bounces = scene.max_depth < 0 ? -1 : std::max(0, scene.max_depth - 2);
  return arguments.bounces.value_or(scene_bounces);
}

void check_crop(const std::optional<CropWindow>& crop, const Camera& camera) {
  if (!crop || (crop->x1 <= camera.width && crop->y1 <= camera.height)) return;
  throw InputError(fmt::format("--crop: the window reaches outside the film of {}x{} pixels", camera.width,
                               camera.height));
}

}  // namespace vrc
