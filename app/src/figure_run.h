// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "figure_panel.h"

namespace vrc {

struct FigureOptions {
  std::filesystem::path output;  ///< Folder that gets one of the figure's own.
  std::filesystem::path scenes;
  FigureSize size = FigureSize::kQuick;
  int threads = 0;  ///< 0: every processor.
  bool quiet = false;
  bool restart = false;
};

/// "figure_07"
[[nodiscard]] std::string figure_folder_name(int number);

struct FigureOutcome {
  std::size_t failed = 0;  ///< Claims that do not hold.
  bool interrupted = false;
};

/// Makes the panels and points of curves that are not there yet, writes the figure's plots and table.json and
/// prints a line for every panel and measure. When `stop` is raised, the table lists what is there. Throws
/// InputError.
[[nodiscard]] FigureOutcome make_figure(const Figure& figure, const FigureOptions& options,
                                        const std::atomic<bool>& stop);

}  // namespace vrc
