// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "chart_export.h"
#include "cli_values.h"
#include "commands.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/timing.h"
#include "io/color.h"
#include "io/image_io.h"
#include "mesh_arguments.h"
#include "shading/false_color.h"
#include "surface_colors.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(
A chart is a connected part of the surface, inside the creases, that is laid out flat without folds.
Of the singular values s1 >= s2 of a face's map to (u, v), stretch is s1 / s2 (1 where no angle changes) and
area distortion max(s1 s2, 1 / (s1 s2)).
.ply: the mesh cut along its charts; vertex properties x y z nx ny nz s t (the packed layout, at most 1) and
face properties red green blue patch stretch area_distortion material. .png: the packed layout.

Examples:
  vrc charts bunny.obj -o bunny_charts.ply -o bunny_layout.png
  vrc charts bunny.obj --color stretch --size 1024x1024 -o bunny_stretch.png)";

enum class ChartColor { kPatch, kStretch, kArea };

struct ChartsArguments {
  MeshArguments mesh;
  PatchAtlasOptions atlas;
  ChartColor color = ChartColor::kPatch;
};

/// Colours of faces; distortions from 1, dark, on a logarithmic scale.
class ChartPainter {
 public:
  ChartPainter(const PatchAtlas& atlas, ChartColor color) : atlas_(atlas), color_(color) {
    if (color == ChartColor::kPatch) return;
    for (std::size_t f = 0; f < atlas.mesh().face_count(); ++f) high_ = std::max(high_, value(f));
  }

  [[nodiscard]] Rgb operator()(std::size_t face) const {
    if (color_ == ChartColor::kPatch) return part_color(atlas_.patch_of(face));
    return map_color(std::log(value(face)) / std::log(high_));
  }
  /// Nothing where colours only tell charts apart.
  [[nodiscard]] std::optional<ColorBar> bar() const {
    if (color_ == ChartColor::kPatch) return std::nullopt;
    return ColorBar{color_ == ChartColor::kStretch ? "stretch (log)" : "area distortion (log)", 1.0, high_,
                    [](double position) { return map_color(position); }};
  }

 private:
  [[nodiscard]] double value(std::size_t face) const {
    if (color_ == ChartColor::kArea) return area_distortion(atlas_, face);
    const Vec2 s = atlas_.singular_values(face);
    return s[0] / s[1];
  }

  const PatchAtlas& atlas_;
  ChartColor color_;
  double high_ = 1.01;  ///< So that rounding has no colours.
};

Image draw_layout(const PatchAtlas& atlas, const ChartPainter& painter, int width, int height) {
  std::vector<Vec2> corners;
  corners.reserve(3 * atlas.mesh().face_count());
  for (std::size_t f = 0; f < atlas.mesh().face_count(); ++f) {
    for (int k = 0; k < 3; ++k) corners.push_back(atlas.layout_uv(f, k));
  }
  const std::optional<ColorBar> bar = painter.bar();
  const int bar_height = bar ? color_bar_height(width, height) : 0;
  const Image picture = render_flat_triangles(corners, atlas.layout_size(), width, height - bar_height,
                                              [&](std::size_t face, const Vec3&) { return painter(face); });
  return bar ? with_color_bar(picture, *bar, bar_height) : picture;
}

std::string summary_text(const MeshArguments& arguments, const PatchAtlas& atlas) {
  const AtlasQuality& quality = atlas.quality();
  const SurfaceMesh& mesh = atlas.mesh();
  const double layout_area = atlas.layout_size().prod();
  std::string text = report_line("mesh", arguments.mesh.string());
  text +=
      report_line("faces", fmt::format("{} in {} smooth regions", mesh.face_count(), mesh.region_count()));
  text += report_line("charts", std::to_string(atlas.patch_count()));
  constexpr std::array<const char*, kChartMethods> kMethods{"conformal", "orthographic", "single faces"};
  for (std::size_t m = 0; m < kChartMethods; ++m) {
    text += report_line(
        fmt::format("  {}", kMethods[m]),
        fmt::format("{} with {} faces", quality.patches_by_method[m], quality.faces_by_method[m]));
  }
  text += report_line("flipped faces", std::to_string(quality.flipped_faces));
  text += report_line("stretch",
                      fmt::format("mean {:.4f}, max {:.4f}", quality.mean_stretch, quality.max_stretch));
  text += report_line("area distortion", fmt::format("mean {:.4f}, max {:.4f}", quality.mean_area_distortion,
                                                     quality.max_area_distortion));
  text +=
      report_line("layout", fmt::format("{:.4g} x {:.4g} units, {:.1f}% filled", atlas.layout_size().x(),
                                        atlas.layout_size().y(), 100.0 * mesh.report().area / layout_area));
  return text;
}

int run_charts(const ChartsArguments& arguments) {
  const PhaseTimer total("total");
  const MeshArguments& common = arguments.mesh;
  check_mesh_arguments(common, {".ply", ".png"});
  set_thread_count(common.threads);
  const MeshInput input = read_mesh_input(common.mesh, common.width, common.height);
  SurfaceMeshOptions options;
  options.creases.crease_angle = common.crease_angle;
  const SurfaceMesh mesh(input.soup, options);
  if (mesh.face_count() == 0) {
    throw InputError(common.mesh.string(), 0, "no face of the mesh has an area; there is nothing to lay out");
  }
  const PhaseTimer building("charts");
  const PatchAtlas atlas = build_patch_atlas(mesh, arguments.atlas);
  const double seconds = building.elapsed().seconds;
  const ChartPainter painter(atlas, arguments.color);
  for (const fs::path& path : common.outputs) {
    if (lower_extension(path) == ".png") {
      write_png(path, draw_layout(atlas, painter, common.width, common.height));
    } else {
      write_surface_ply(path, chart_export(atlas, painter));
    }
  }
  std::cout << summary_text(common, atlas)
            << report_line("time", fmt::format("{:.2f} s, of which charts {:.2f} s", total.elapsed().seconds,
                                               seconds))
            << std::flush;
  return kExitDone;
}

}  // namespace

CommandAction add_charts_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("charts", "Lay a mesh out flat in charts");
  const auto arguments = std::make_shared<ChartsArguments>();
  declare_mesh_options(*command, arguments->mesh, "File to write: .ply or .png");
  add_choice(*command, "--color", arguments->color,
             {{"patch", ChartColor::kPatch}, {"stretch", ChartColor::kStretch}, {"area", ChartColor::kArea}},
             "What the colours show: which chart, angle distortion or area distortion");
  add_number(*command, "--cone-angle", arguments->atlas.cone_angle, NumberRange<double>{1.0, 80.0},
             "Charts grow to faces whose normals are at most this far from their axis, in degrees");
  command->footer(kFooter);
  return [arguments] { return run_charts(*arguments); };
}

}  // namespace vrc
