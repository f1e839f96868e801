// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "cli_values.h"
#include "commands.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/timing.h"
#include "curvature_export.h"
#include "curvature_values.h"
#include "io/color.h"
#include "io/image_io.h"
#include "mesh_arguments.h"
#include "placement/cache_options.h"
#include "shading/false_color.h"
#include "surface_colors.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

/// With the accepted turn of the normal to be filled in.
constexpr const char* kFooter = R"(
k1 >= k2 are the principal curvatures, positive where the surface is convex, in 1 / unit of length;
d1 and d2 their directions; mean = (k1 + k2) / 2, gauss = k1 k2, max = max(|k1|, |k2|). They do not reach
across creases. sh_radius is the distance over which the normal turns by {:g} rad, the most that a Taylor
record of the cache accepts by default. Colours span the 2nd to the 98th percentile; signed quantities
run from blue (negative) over grey to orange (positive), max from dark violet to yellow.
.ply: vertex properties x y z nx ny nz red green blue quality (max) k1 k2 mean gauss d1x d1y d1z d2x d2y
d2z sh_radius, face properties patch region material; .vtp: the same for ParaView, with vector arrays;
.png: a picture of the mesh in these colours.

Examples:
  vrc curvature bunny.obj -o bunny.ply -o bunny.png
  vrc curvature bunny.obj --quantity gauss --curvature jet -o bunny.vtp)";

struct CurvatureArguments {
  MeshArguments mesh;
  CurvatureQuantity quantity = CurvatureQuantity::kMean;
  CurvatureOptions estimator;
};

std::string name_of(CurvatureQuantity quantity) {
  switch (quantity) {
    case CurvatureQuantity::kMean:
      return "mean";
    case CurvatureQuantity::kK1:
      return "k1";
    case CurvatureQuantity::kK2:
      return "k2";
    case CurvatureQuantity::kGauss:
      return "gauss";
    case CurvatureQuantity::kMax:
      return "max";
  }
  VRC_CHECK(false, "quantity {}", static_cast<int>(quantity));
}

std::string unit_of(CurvatureQuantity quantity) {
  return quantity == CurvatureQuantity::kGauss ? "1/unit^2" : "1/unit";
}

/// The chosen quantity on the mesh, and its colours.
struct CurvatureView {
  std::vector<PrincipalCurvatures> sectors;
  CurvatureQuantity quantity;
  ValueSummary summary;
  ValueRange range;

  [[nodiscard]] double value(std::size_t sector) const { return value_of(sectors[sector], quantity); }
  [[nodiscard]] Rgb map(double position) const {
    return is_signed(quantity) ? map_diverging(position) : map_color(position);
  }
  [[nodiscard]] Rgb color(double value) const { return map((value - range.low) / (range.high - range.low)); }
};

CurvatureView make_view(const CurvatureField& field, CurvatureQuantity quantity) {
  CurvatureView view{principal_curvatures(field), quantity, {}, {}};
  std::vector<double> values(view.sectors.size());
  for (std::size_t s = 0; s < values.size(); ++s) values[s] = view.value(s);
  view.summary = summarize(std::move(values));
  view.range = color_range(view.summary, quantity, field.mesh().report().bounds.diagonal().norm());
  return view;
}

Image draw(const SurfaceMesh& mesh, const Camera& camera, int bar_height, const CurvatureView& view) {
  const auto color = [&](std::size_t face, const Vec3& b) {
    double value = 0.0;
    for (int k = 0; k < 3; ++k) value += b[k] * view.value(mesh.corner_sector(face, k));
    return view.color(value);
  };
  const ColorBar bar{name_of(view.quantity) + " curvature " + unit_of(view.quantity), view.range.low,
                     view.range.high, [&](double position) { return view.map(position); }};
  return with_color_bar(render_false_color(mesh, camera, color), bar, bar_height);
}

void write_outputs(const MeshArguments& arguments, const SurfaceMesh& mesh, const Camera& camera,
                   int bar_height, const CurvatureView& view) {
  std::optional<SurfaceExport> surface;
  for (const fs::path& path : arguments.outputs) {
    const std::string extension = lower_extension(path);
    if (extension == ".png") {
      write_png(path, draw(mesh, camera, bar_height, view));
      continue;
    }
    if (!surface) {
      surface = curvature_export(build_patch_atlas(mesh), view.sectors, kLargestNormalDeviation,
                                 [&](std::size_t sector) { return view.color(view.value(sector)); });
    }
    extension == ".ply" ? write_surface_ply(path, *surface) : write_surface_vtp(path, *surface);
  }
}

std::string component_lines(std::span<const ComponentCurvature> components) {
  constexpr std::size_t kShown = 8;
  std::string text;
  std::size_t closed = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const ComponentCurvature& c = components[i];
    if (!c.closed || ++closed > kShown) continue;
    const double expected = 2.0 * kPi * c.euler_characteristic;
    std::string line = fmt::format("component {}: sum of K dA {:.5g}, 2 pi chi {:.5g}, defect {:.3g}", i,
                                   c.gauss_integral, expected, c.gauss_integral - expected);
    if (c.crease_edges > 0) line += fmt::format(" (bends at {} crease edges are not in it)", c.crease_edges);
    text += report_line("Gauss-Bonnet", line);
  }
  if (closed > kShown) text += report_line("", fmt::format("and {} more closed components", closed - kShown));
  if (closed == 0) text += report_line("Gauss-Bonnet", "no closed component to test");
  return text;
}

std::string summary_text(const CurvatureArguments& arguments, const CurvatureField& field,
                         const CurvatureView& view) {
  const SurfaceMesh& mesh = field.mesh();
  const auto creases =
      std::ranges::count_if(mesh.creases(), [](std::uint8_t reasons) { return reasons != 0; });
  const bool jet = arguments.estimator.method == CurvatureMethod::kJet;
  std::string text = report_line("mesh", arguments.mesh.mesh.string());
  text += report_line("faces", std::to_string(mesh.face_count()));
  text += report_line("sectors", fmt::format("{} at {} vertices", mesh.sector_count(), mesh.vertex_count()));
  text += report_line("crease edges", std::to_string(creases));
  text += report_line("estimator", jet ? fmt::format("jet; tensor at {} sectors with too few neighbours",
                                                     field.fallback_count())
                                       : std::string("tensor"));
  text += report_line(fmt::format("{} [{}]", name_of(view.quantity), unit_of(view.quantity)),
                      fmt::format("min {:.5g}, median {:.5g}, max {:.5g}", view.summary.min,
                                  view.summary.median, view.summary.max));
  text += report_line("colours", fmt::format("{:.5g} to {:.5g}", view.range.low, view.range.high));
  return text + component_lines(integrate_components(mesh, view.sectors));
}

int run_curvature(const CurvatureArguments& arguments) {
  const PhaseTimer total("total");
  const MeshArguments& common = arguments.mesh;
  check_mesh_arguments(common, {".ply", ".vtp", ".png"});
  set_thread_count(common.threads);
  const int bar_height = color_bar_height(common.width, common.height);
  const MeshInput input = read_mesh_input(common.mesh, common.width, common.height - bar_height);
  SurfaceMeshOptions options;
  options.creases.crease_angle = common.crease_angle;
  const SurfaceMesh mesh(input.soup, options);
  if (mesh.face_count() == 0) {
    throw InputError(common.mesh.string(), 0, "no face of the mesh has an area; there is nothing to measure");
  }
  if (arguments.estimator.method == CurvatureMethod::kJet) {
    std::cerr << fmt::format("note: fitting jets at {} sectors\n", mesh.sector_count());
  }
  const PhaseTimer estimating("estimate");
  const CurvatureField field = estimate_curvature(mesh, arguments.estimator);
  const double seconds = estimating.elapsed().seconds;
  const CurvatureView view = make_view(field, arguments.quantity);
  write_outputs(common, mesh, input.camera, bar_height, view);
  std::cout << summary_text(arguments, field, view)
            << report_line("time", fmt::format("{:.2f} s, of which curvature {:.2f} s",
                                               total.elapsed().seconds, seconds))
            << std::flush;
  return kExitDone;
}

}  // namespace

CommandAction add_curvature_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("curvature", "Measure and draw the curvature of a mesh");
  const auto arguments = std::make_shared<CurvatureArguments>();
  declare_mesh_options(*command, arguments->mesh, "File to write: .ply, .vtp or .png");
  add_choice(*command, "--quantity", arguments->quantity,
             {{"mean", CurvatureQuantity::kMean},
              {"k1", CurvatureQuantity::kK1},
              {"k2", CurvatureQuantity::kK2},
              {"gauss", CurvatureQuantity::kGauss},
              {"max", CurvatureQuantity::kMax}},
             "What the colours show");
  add_choice(*command, "--curvature", arguments->estimator.method,
             {{"tensor", CurvatureMethod::kFaceTensors}, {"jet", CurvatureMethod::kJet}},
             "From differences of the shading normals, or from polynomials fitted to the positions (slow)");
  command->footer(fmt::format(kFooter, kLargestNormalDeviation));
  return [arguments] { return run_curvature(*arguments); };
}

}  // namespace vrc
