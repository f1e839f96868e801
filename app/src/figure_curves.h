// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "figure_panel.h"
#include "plot_svg.h"

namespace vrc {

/// The panels of a group and then the points of its curves, each once.
[[nodiscard]] std::vector<FigurePanel> runs_of(const FigureGroup& group);

/// The ids of a series' points, in their order.
[[nodiscard]] std::vector<std::string> points_of(const FigureSeries& series);

struct DrawnCurves {
  std::string file;  ///< Name of the plot as a picture, .svg.
  LabelledPlot plot;
};

/// The plots of a figure. They show the points that are there and whose numbers are positive: an error below
/// the reference's noise may not be.
[[nodiscard]] std::vector<DrawnCurves> drawn_curves(const Figure& figure, const PanelStamps& stamps);

}  // namespace vrc
