// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "cli_values.h"
#include "commands.h"
#include "core/error.h"
#include "io/obj_reader.h"
#include "io/ply_reader.h"
#include "io/scene_reader.h"
#include "mesh_arguments.h"
#include "shape_report.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(
Defects are found, repaired where that is possible, and reported; they do not make the command fail.
Counts are those of the repaired mesh: equal positions are welded, polygons are cut into triangles, faces
without area and repeated faces are left out, and faces are detached from each other along non-manifold
edges. Polygons are numbered from 0 in the order of the file.

Examples:
  vrc inspect bunny.obj
  vrc inspect part.ply --self-intersections --json
  vrc inspect scenes/cornell_glossy.xml
Exit codes: 0 the file was read, whatever its defects; 2 the file or the usage is wrong.)";

struct InspectArguments {
  fs::path file;
  ShapeReportOptions report;
  bool lenient = false;
  bool json = false;
};

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::cerr << "warning: " << warning << "\n";
}

/// A bare mesh is read without its materials' files and without a camera, so that any mesh will do.
std::vector<ShapeDescription> read_shapes(const InspectArguments& arguments) {
  const std::string kind = lower_extension(arguments.file);
  if (kind == ".obj" || kind == ".ply") {
    if (!fs::is_regular_file(arguments.file)) {
      throw InputError(arguments.file.string(), 0, "there is no such file; check the name");
    }
    ShapeDescription shape;
    if (kind == ".obj") {
      ObjFile obj = read_obj(arguments.file);
      print_warnings(obj.warnings);
      shape.soup = std::move(obj.soup);
    } else {
      shape.soup = read_ply(arguments.file);
    }
    shape.id = arguments.file.stem().string();
    std::vector<ShapeDescription> shapes;
    shapes.push_back(std::move(shape));
    return shapes;
  }
  SceneReadOptions options;
  options.lenient = arguments.lenient;
  SceneDescription scene = read_scene(arguments.file, options);
  print_warnings(scene.warnings);
  return std::move(scene.shapes);
}

int run_inspect(const InspectArguments& arguments) {
  std::vector<ShapeReport> reports;
  for (const ShapeDescription& shape : read_shapes(arguments)) {
    reports.push_back(inspect_shape(shape, arguments.report));
  }
  std::cout << (arguments.json ? reports_as_json(arguments.file.string(), arguments.report, reports)
                               : reports_as_text(arguments.file.string(), reports))
            << std::flush;
  return kExitDone;
}

}  // namespace

CommandAction add_inspect_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("inspect", "Report counts and defects of meshes");
  const auto arguments = std::make_shared<InspectArguments>();
  command->add_option("file", arguments->file, "Mesh (.obj, .ply) or Mitsuba 3 scene (.xml)")
      ->type_name("MESH|SCENE")
      ->required();
  add_number(*command, "--crease-angle", arguments->report.crease_angle, NumberRange<double>{0.0, 180.0},
             "Edges that bend by more are creases, in degrees; supplied normals go before");
  command->add_flag("--self-intersections", arguments->report.self_intersections,
                    "Also look for faces that pass through each other (exact; takes longer)");
  command->add_flag("--lenient", arguments->lenient,
                    "Warn about what is not understood in a scene instead of stopping");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->footer(kFooter);
  return [arguments] { return run_inspect(*arguments); };
}

}  // namespace vrc
