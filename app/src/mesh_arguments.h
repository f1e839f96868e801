// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/polygon_soup.h"
#include "transport/camera.h"

namespace CLI {
class App;
}

namespace vrc {

/// What the commands that show a property of one mesh have in common.
struct MeshArguments {
  std::filesystem::path mesh;
  std::vector<std::filesystem::path> outputs;
  double crease_angle = 40.0;  ///< [degrees]
  int width = 800, height = 600;
  int threads = 0;  ///< 0: every processor.
};

/// Declares the mesh, -o, --crease-angle, --size and --threads; `arguments` must live as long as `command`.
void declare_mesh_options(CLI::App& command, MeshArguments& arguments, const std::string& output_help);

/// Of a file name, in lower case, with the point; "" without one.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Throws InputError when the mesh is missing or of another kind, when an output has none of the
/// `extensions`, cannot be written, is named twice or is the mesh.
void check_mesh_arguments(const MeshArguments& arguments, std::initializer_list<std::string_view> extensions);

/// A mesh file and a camera that frames it in a picture of the given size.
struct MeshInput {
  PolygonSoup soup;
  Camera camera;
};

/// Prints the reader's warnings to standard error. Throws InputError when the mesh cannot be used.
[[nodiscard]] MeshInput read_mesh_input(const std::filesystem::path& path, int width, int height);

/// One line of a report: the value in a column of its own.
[[nodiscard]] std::string report_line(std::string_view name, std::string_view value);

}  // namespace vrc
