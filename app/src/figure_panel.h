// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <map>

#include "figure.h"
#include "figure_stamp.h"

namespace vrc {

/// Where and how the panels of a figure are made.
struct PanelPlace {
  std::filesystem::path folder;  ///< Of the figure.
  std::filesystem::path scenes;
  int threads = 0;  ///< 0: every processor.
  bool quiet = false;
  bool restart = false;  ///< Panels are made even if they are there.
};

/// The panels that are there, by their ids.
using PanelStamps = std::map<std::string, PanelStamp, std::less<>>;

struct MadePanel {
  PanelStamp stamp;
  bool kept = false;  ///< It was there already.
};

/// Makes a panel, or finds it made from the same command, scene, program version and panels that it depends
/// on (`earlier`). `scene_key` is a hash of what the scene's files hold. Its files are whole or absent, and
/// ID.json comes last. Throws InputError, and Interrupted when `stop` is raised.
[[nodiscard]] MadePanel make_panel(const FigureGroup& group, const FigurePanel& panel,
                                   std::uint64_t scene_key, const PanelStamps& earlier,
                                   const PanelPlace& place, const std::atomic<bool>& stop);

}  // namespace vrc
