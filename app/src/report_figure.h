// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "plot_svg.h"

namespace vrc {

/// Named numbers as they are shown, in the order of the file.
using ReportValues = std::vector<std::pair<std::string, std::string>>;

/// A picture of a figure and what was measured of it.
struct ReportPanel {
  std::string id, name, scene, command;          ///< The last two may be empty.
  std::filesystem::path image;                   ///< Exists.
  std::optional<std::filesystem::path> records;  ///< Likewise.
  std::optional<std::size_t> reference;          ///< Panel of the same group.
  ReportValues ours, paper;
};

/// Pictures of one size and camera.
struct ReportGroup {
  std::string name;
  std::vector<ReportPanel> panels;
};

struct ReportMeasure {
  std::string name, value, bound, paper;  ///< The last three may be empty.
  std::optional<bool> holds;              ///< Nothing where nothing was to hold.
};

/// What a folder's table.json says of a figure.
struct ReportFigure {
  int number = 0;
  std::string title, claim, size;  ///< The last two may be empty.
  std::vector<ReportGroup> groups;
  std::vector<ReportMeasure> measures;
  std::vector<LabelledPlot> curves;
};

/// Reads FOLDER/table.json, format "vrc figure 1". Fields that it does not know are left out. Throws
/// InputError, naming file and field, when something is missing or is not what it must be, also for files
/// that it names.
[[nodiscard]] ReportFigure read_report_figure(const std::filesystem::path& folder);

/// The folders themselves that hold a table.json, or the folders in them that do, by name; none twice.
/// Throws InputError for one without.
[[nodiscard]] std::vector<std::filesystem::path> figure_folders(
    std::span<const std::filesystem::path> folders);

}  // namespace vrc
