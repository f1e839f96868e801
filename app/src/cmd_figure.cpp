// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/command_line.h"
#include "cli_values.h"
#include "commands.h"
#include "core/error.h"
#include "figure_run.h"
#include "interrupt.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(
Renders every panel of a figure of the paper with its settings into DIR/figure_NN: pictures (.exr, .png), errors
against a reference in false colours (_error.png), records (_records.csv, and drawn in _records.png), plots of
errors over records, rays and CPU time (.svg), and table.json with our numbers, the paper's, the curves of the
plots and the figure's claims in numbers. Exit code 1 if one does not hold.
Panels that are there, of the same command, scene and program version, are kept; Ctrl-C ends the work in good
order, and the same command goes on.

Examples:
  vrc figure 7 -o figures
  vrc figure all --full -o figures)";

struct FigureArguments : FigureOptions {
  std::vector<int> numbers;
};

bool read_numbers(const std::string& text, std::vector<int>& numbers) {
  numbers.clear();
  if (text == "all") {
    for (int n = kFirstFigure; n <= kLastFigure; ++n) numbers.push_back(n);
  } else if (const auto n = parse_number<int>(text, {kFirstFigure, kLastFigure})) {
    numbers.push_back(*n);
  }
  return !numbers.empty();
}

void declare_options(CLI::App& command, FigureArguments& arguments) {
  add_value(command, "figure", "N", "Figure of the paper, 1 to 12, or all", "a figure from 1 to 12, or all",
            [&arguments](const std::string& text) { return read_numbers(text, arguments.numbers); })
      ->required();
  command
      .add_option("-o,--output", arguments.output, "Folder that gets a folder for each figure; it is made")
      ->type_name("DIR")
      ->required();
  CLI::Option* quick = command.add_flag_callback(
      "--quick", [&arguments] { arguments.size = FigureSize::kQuick; },
      "Small pictures with few rays and records, under a minute for a figure; the default");
  command
      .add_flag_callback(
          "--full", [&arguments] { arguments.size = FigureSize::kFull; },
          "The paper's sizes, rays and records")
      ->excludes(quick);
  command.add_flag("--restart", arguments.restart, "Make every panel again");
  command.add_option("--scenes", arguments.scenes, "Folder of the scene files")
      ->type_name("DIR")
      ->default_str("those of the program's sources");
  add_number(command, "--threads", arguments.threads, NumberRange<int>{1, 1024},
             "Worker threads; the pictures do not depend on them", "one for each processor");
  command.add_flag("-q,--quiet", arguments.quiet, "No progress and no notes");
  command.footer(kFooter);
}

int run_figures(FigureArguments arguments) {
  if (arguments.scenes.empty()) arguments.scenes = VRC_SCENES_DIR;
  if (!fs::is_directory(arguments.scenes)) {
    throw InputError(
        arguments.scenes.string(), 0,
        "there is no such folder of scenes; name one that has the scenes of the program's sources "
        "with --scenes");
  }
  arguments.scenes = fs::canonical(arguments.scenes);
  const InterruptGuard interrupt;
  std::size_t failed = 0;
  for (const int number : arguments.numbers) {
    const FigureOutcome outcome =
        make_figure(figure_of_paper(number, arguments.size), arguments, interrupt.flag());
    failed += outcome.failed;
    if (outcome.interrupted) {
      std::cerr << fmt::format("vrc: interrupted in figure {}: the same command goes on\n", number);
      return kExitInterrupted;
    }
  }
  if (failed == 0) return kExitDone;
  std::cerr << fmt::format("vrc: {} of the claims {} not hold\n", failed, failed == 1 ? "does" : "do");
  return kExitFailure;
}

}  // namespace

CommandAction add_figure_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("figure", "Make a figure of the paper anew and check what it claims");
  const auto arguments = std::make_shared<FigureArguments>();
  declare_options(*command, *arguments);
  return [arguments] { return run_figures(*arguments); };
}

}  // namespace vrc
