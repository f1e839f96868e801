// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_arguments.h"

#include <algorithm>
#include <iostream>

#include "cli_values.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/scene_reader.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error);
}

void check_extension(const fs::path& output, std::initializer_list<std::string_view> extensions) {
  const std::string own = lower_extension(output);
  if (std::ranges::find(extensions, own) != extensions.end()) return;
  std::string list;
  for (const std::string_view e : extensions) list += (list.empty() ? "" : ", ") + std::string(e);
  throw InputError(output.string(), 0,
                   fmt::format("not a kind of file that this command writes; choose one of {}", list));
}

}  // namespace

void declare_mesh_options(CLI::App& command, MeshArguments& arguments, const std::string& output_help) {
  command.add_option("mesh", arguments.mesh, "Mesh file (.obj, .ply)")->type_name("MESH")->required();
  command.add_option("-o,--output", arguments.outputs, output_help + "; may be repeated")
      ->type_name("FILE")
      ->required()
      ->allow_extra_args(false);
  add_number(command, "--crease-angle", arguments.crease_angle, NumberRange<double>{0.0, 180.0},
             "Edges that bend by more are creases, in degrees; supplied normals go before");
  add_value(command, "--size", "WxH", "Size of PNG files in pixels",
            "a size such as 640x480, at most 16384x16384",
            [&arguments](const std::string& text) {
              const auto size = parse_size(text);
              if (size) std::tie(arguments.width, arguments.height) = *size;
              return size.has_value();
            })
      ->default_str(fmt::format("{}x{}", arguments.width, arguments.height));
  add_number(command, "--threads", arguments.threads, NumberRange<int>{1, 1024},
             "Worker threads; the files do not depend on them", "one for each processor");
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void check_mesh_arguments(const MeshArguments& arguments,
                          std::initializer_list<std::string_view> extensions) {
  const std::string kind = lower_extension(arguments.mesh);
  if (kind != ".obj" && kind != ".ply") {
    throw InputError(arguments.mesh.string(), 0, "not a known kind of mesh; give an .obj or .ply file");
  }
  std::error_code error;
  if (!fs::exists(arguments.mesh, error)) throw InputError(arguments.mesh.string(), 0, "no such file");
  const auto& outputs = arguments.outputs;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    check_extension(outputs[i], extensions);
    require_writable(outputs[i]);
    for (std::size_t k = 0; k < i; ++k) {
      if (same_file(outputs[i], outputs[k]))
        throw InputError(outputs[i].string(), 0, "is named for two outputs");
    }
    if (same_file(outputs[i], arguments.mesh)) {
      throw InputError(outputs[i].string(), 0, "is an input of this command; write to another file");
    }
  }
}

MeshInput read_mesh_input(const fs::path& path, int width, int height) {
  SceneReadOptions options;
  options.width = width;
  options.height = height;
  SceneDescription scene = read_scene(path, options);
  for (const std::string& warning : scene.warnings) std::cerr << "warning: " << warning << "\n";
  // The reader gives a bare mesh as the first shape; a stand-in light may follow.
  return {std::move(scene.shapes.front().soup), scene.camera};
}

std::string report_line(std::string_view name, std::string_view value) {
  return fmt::format("{:<24}{}\n", name, value);
}

}  // namespace vrc
