// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace vrc {

struct PlotSeries {
  std::string name;
  std::vector<Vec2> points;  ///< Finite; drawn in this order, joined by lines.
};

struct PlotPanel {
  std::string title;
  std::vector<PlotSeries> series;
};

/// A panel with the names of its axes.
struct LabelledPlot {
  PlotPanel panel;
  std::string x_label, y_label;
};

/// What a plot is drawn on: white, or a page whose colour and font of text it takes over.
enum class PlotPaper { kWhite, kPage };

/// Panels side by side, as a document of Scalable Vector Graphics. An axis is logarithmic if all its values
/// are positive, otherwise linear (PlotAxis). Series of one name have one colour (of six that also differ
/// without colour vision), shape and dashes; a legend tells which.
[[nodiscard]] std::string plot_svg(std::span<const PlotPanel> panels, const std::string& x_label,
                                   const std::string& y_label, PlotPaper paper = PlotPaper::kWhite);
[[nodiscard]] std::string plot_svg(const LabelledPlot& plot, PlotPaper paper = PlotPaper::kWhite);

}  // namespace vrc
