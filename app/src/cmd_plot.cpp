// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/command_line.h"
#include "commands.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "mesh_arguments.h"
#include "plot_svg.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFooter = R"(
Draws relMSE over CPU seconds, a panel for each scene, on logarithmic axes: the radiance cache and, where the file
has it, path tracing.

Example:
  bench_equal_time --time 0.5 1.5 5 15 --json bench.json
  vrc plot bench.json -o bench.svg)";

struct PlotArguments {
  fs::path input, output;
};

json read_json(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError(path.string(), 0, "cannot be opened; give a file that bench_equal_time --json wrote");
  try {
    return json::parse(in);
  } catch (const json::exception& error) {
    throw InputError(
        path.string(), 0,
        fmt::format("is no JSON ({}); give a file that bench_equal_time --json wrote", error.what()));
  }
}

/// The points of "cache" or "path" in a scene's rows, by rising time.
PlotSeries series_of(const json& rows, const char* key, const char* name) {
  PlotSeries series{name, {}};
  for (const json& row : rows) {
    if (!row.contains(key)) continue;
    const Vec2 point(row.at(key).at("cpu_seconds").get<double>(), row.at(key).at("relmse").get<double>());
    if ((point.array() > 0.0).all() && point.allFinite()) series.points.push_back(point);
  }
  std::ranges::sort(series.points, {}, [](const Vec2& p) { return p.x(); });
  return series;
}

std::vector<PlotPanel> panels_of(const fs::path& path, const json& bench) {
  std::vector<PlotPanel> panels;
  try {
    for (const json& scene : bench.at("scenes")) {
      PlotPanel panel{fs::path(scene.at("scene").get<std::string>()).stem().string(), {}};
      panel.series = {series_of(scene.at("rows"), "cache", "radiance cache"),
                      series_of(scene.at("rows"), "path", "path tracing")};
      std::erase_if(panel.series, [](const PlotSeries& s) { return s.points.empty(); });
      if (!panel.series.empty()) panels.push_back(std::move(panel));
    }
  } catch (const json::exception& error) {
    throw InputError(path.string(), 0,
                     fmt::format("has not what bench_equal_time --json writes: {}", error.what()));
  }
  if (panels.empty()) throw InputError(path.string(), 0, "holds no measurements to plot");
  return panels;
}

int run_plot(const PlotArguments& arguments) {
  if (lower_extension(arguments.output) != ".svg")
    throw InputError(arguments.output.string(), 0, "plots are written as .svg; choose this extension");
  const std::vector<PlotPanel> panels = panels_of(arguments.input, read_json(arguments.input));
  write_file_atomically(arguments.output, plot_svg(panels, "CPU seconds", "relMSE"));
  return kExitDone;
}

}  // namespace

CommandAction add_plot_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("plot", "Draw measurements of bench_equal_time");
  const auto arguments = std::make_shared<PlotArguments>();
  command->add_option("input", arguments->input, "What bench_equal_time --json wrote")
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--output", arguments->output, "Plot to write, .svg")->type_name("FILE")->required();
  command->footer(kFooter);
  return [arguments] { return run_plot(*arguments); };
}

}  // namespace vrc
