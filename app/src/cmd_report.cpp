// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "commands.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "mesh_arguments.h"
#include "report_figure.h"
#include "report_page.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(
The page holds everything and needs no network: pictures with exposure, tone curves, flipping, split views, errors
in false colour and the records with their numbers; tables beside the paper's; plots. '?' in it lists the keys.
Errors are those of 'vrc compare', in its colours. Pixels that are not finite are magenta.

Examples:
  vrc figure all -o figures && vrc report figures -o report.html
  vrc report figures/figure_07 -o figure_07.html)";

struct ReportArguments {
  std::vector<fs::path> folders;
  fs::path output;
};

int run_report(const ReportArguments& arguments) {
  if (lower_extension(arguments.output) != ".html")
    throw InputError(arguments.output.string(), 0, "reports are written as .html; choose this extension");
  require_writable(arguments.output);
  std::vector<ReportFigure> figures;
  for (const fs::path& folder : figure_folders(arguments.folders))
    figures.push_back(read_report_figure(folder));
  const std::string page = report_page(figures);
  write_file_atomically(arguments.output, page);
  std::cout << fmt::format("{}: {} figure{}, {:.1f} MB\n", arguments.output.string(), figures.size(),
                           figures.size() == 1 ? "" : "s", 1e-6 * static_cast<double>(page.size()));
  return kExitDone;
}

}  // namespace

CommandAction add_report_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("report", "Make a page of figures to look at");
  const auto arguments = std::make_shared<ReportArguments>();
  command
      ->add_option("folders", arguments->folders,
                   "What 'vrc figure' wrote: folders that hold a table.json, or folders of such")
      ->type_name("DIR")
      ->required();
  command->add_option("-o,--output", arguments->output, "Page to write, .html")
      ->type_name("FILE")
      ->required();
  command->footer(kFooter);
  return [arguments] { return run_report(*arguments); };
}

}  // namespace vrc
