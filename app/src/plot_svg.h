// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace vrc {

struct PlotSeries {
  std::string name;
  std::vector<Vec2> points;  ///< Both coordinates positive; drawn in this order, joined by lines.
};

struct PlotPanel {
  std::string title;
  std::vector<PlotSeries> series;
};

/// Panels side by side on logarithmic axes, as a document of Scalable Vector Graphics. Series of one name
/// have one colour (of four that also differ without colour vision, and in shape); a legend tells which.
[[nodiscard]] std::string plot_svg(std::span<const PlotPanel> panels, const std::string& x_label,
                                   const std::string& y_label);

}  // namespace vrc
