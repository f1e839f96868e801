// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace vrc {

/// Runs a command whose arguments were parsed; returns the exit code.
using CommandAction = std::function<int()>;

/// Each declares one subcommand of `program` (options and help) and returns what runs it.
/// `command_line` is what the user typed, for the records that the command writes.
[[nodiscard]] CommandAction add_render_command(CLI::App& program, const std::string& command_line);
[[nodiscard]] CommandAction add_records_command(CLI::App& program, const std::string& command_line);
[[nodiscard]] CommandAction add_derivatives_command(CLI::App& program, const std::string& command_line);
[[nodiscard]] CommandAction add_compare_command(CLI::App& program);
[[nodiscard]] CommandAction add_inspect_command(CLI::App& program);
[[nodiscard]] CommandAction add_curvature_command(CLI::App& program);
[[nodiscard]] CommandAction add_charts_command(CLI::App& program);
[[nodiscard]] CommandAction add_plot_command(CLI::App& program);
[[nodiscard]] CommandAction add_figure_command(CLI::App& program);
[[nodiscard]] CommandAction add_report_command(CLI::App& program);

}  // namespace vrc
