// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "figure_panel.h"

namespace vrc {

/// What a user would type for a panel, and what it means.
template <typename Arguments>
struct PanelCommand {
  std::string text;  ///< Files without their folders.
  Arguments arguments;
};

/// Parses the words of the group and then `words` by the command's own declarations; `output` is the name of
/// what it writes into the figure's folder.
template <typename Arguments>
[[nodiscard]] PanelCommand<Arguments> panel_command(const std::string& name,
                                                    void (*declare)(CLI::App&, Arguments&),
                                                    const FigureGroup& group, const std::string& words,
                                                    const std::string& output, const PanelPlace& place) {
  const std::vector<std::string> options = words_of(group.words + " " + words);
  PanelCommand<Arguments> command;
  command.text =
      fmt::format("vrc {} {} {} -o {}", name, (place.scenes.filename() / group.scene).generic_string(),
                  fmt::join(options, " "), output);
  std::vector<std::string> typed = {name, (place.scenes / group.scene).string()};
  typed.insert(typed.end(), options.begin(), options.end());
  typed.insert(typed.end(), {"-o", (place.folder / output).string()});
  std::ranges::reverse(typed);  // as CLI11 takes them

  CLI::App program;
  declare(*program.add_subcommand(name), command.arguments);
  program.parse(typed);
  command.arguments.threads = place.threads;
  command.arguments.quiet = place.quiet;
  return command;
}

}  // namespace vrc
