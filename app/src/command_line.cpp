// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <new>
#include <string>

#include "app/version.h"
#include "commands.h"
#include "core/error.h"

namespace vrc {
namespace {

constexpr const char* kFooter = R"(
Examples:
  vrc render scenes/cornell_glossy.xml -o box.exr -o box.png
  vrc render bunny.ply --camera-origin 0,1,4 --camera-target 0,0.5,0 -o bunny.png
  vrc records scenes/curved_room.xml -o records.vtp --overlay records.png
  vrc derivatives scenes/half_box.xml -o half_box --size 128x128
  vrc compare box.exr reference.exr
  vrc inspect bunny.ply
  vrc curvature bunny.ply -o curvature.png
  vrc plot bench.json -o bench.svg
  vrc figure 7 -o figures
  vrc report figures -o report.html

"vrc COMMAND --help" explains one command.
Exit codes: 0 done; 1 internal error, a comparison met values that are not finite, or a claim of a figure does
not hold; 2 bad input or usage; 130 interrupted.)";

/// Puts defaults behind the description: "Rays of a record [by sharpness]".
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(34); }
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string type = option->get_type_name();
    return type.empty() ? "" : " " + type;
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    std::string text = option->get_description();
    if (option->get_required()) text += " (required)";
    if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
    return text;
  }
};

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ';');
  return text;
}

std::string joined(int argc, const char* const* argv) {
  std::string text;
  for (int i = 0; i < argc; ++i) text += (i == 0 ? "" : " ") + std::string(argv[i]);
  return text;
}

int report_usage_error(const CLI::App& program, const CLI::ParseError& error) {
  const auto used = program.get_subcommands();
  const std::string command = used.empty() ? "vrc" : "vrc " + used.front()->get_name();
  std::cerr << fmt::format("vrc: error: {}; see '{} --help'\n", one_line(error.what()), command);
  return kExitBadInput;
}

int parse_and_run(int argc, const char* const* argv) {
  CLI::App program{"vrc renders glossy global illumination on meshes by view-dependent radiance caching.",
                   "vrc"};
  program.set_version_flag("--version", "vrc " + std::string(kVersion), "Print the version and exit");
  program.set_help_flag("-h,--help", "Print this help and exit");
  program.require_subcommand(0, 1);  // without one, the message below is clearer
  program.formatter(std::make_shared<HelpFormatter>());
  program.footer(kFooter);
  const std::map<std::string, CommandAction> actions{
      {"render", add_render_command(program, joined(argc, argv))},
      {"records", add_records_command(program, joined(argc, argv))},
      {"derivatives", add_derivatives_command(program, joined(argc, argv))},
      {"compare", add_compare_command(program)},
      {"inspect", add_inspect_command(program)},
      {"curvature", add_curvature_command(program)},
      {"charts", add_charts_command(program)},
      {"plot", add_plot_command(program)},
      {"figure", add_figure_command(program)},
      {"report", add_report_command(program)},
  };
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return program.exit(request, std::cout, std::cerr);
  } catch (const CLI::ParseError& error) {
    return report_usage_error(program, error);
  }
  if (program.get_subcommands().empty()) {
    throw InputError(
        "give a command: render or compare for pictures, records or derivatives for the cache, figure for "
        "those of "
        "the paper, inspect, curvature or charts for meshes; see 'vrc --help'");
  }
  return actions.at(program.get_subcommands().front()->get_name())();
}

int report(const char* kind, const char* what, ExitCode code) {
  std::cerr << "vrc: " << kind << what << "\n";
  return code;
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  try {
    return parse_and_run(argc, argv);
  } catch (const InputError& error) {
    return report("error: ", error.what(), kExitBadInput);
  } catch (const Interrupted&) {
    return report("interrupted: ", "nothing was written", kExitInterrupted);
  } catch (const std::bad_alloc&) {
    return report("error: ", "out of memory; use a smaller picture, fewer records or a smaller scene",
                  kExitFailure);
  } catch (const std::exception& error) {
    return report("internal error: ", error.what(), kExitFailure);
  }
}

}  // namespace vrc
