// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>

#include "figure_curves.h"

namespace vrc {

/// A measure of which all panels are there.
struct MeasuredValue {
  const FigureMeasure* measure = nullptr;
  double value = 0.0;

  [[nodiscard]] bool holds() const { return !measure->bound || measure->bound->holds(value); }
};

/// ">= 2"
[[nodiscard]] std::string bound_text(const FigureBound& bound);

/// table.json: the panels that are there, and the measures and curves that they allow. Numbers that are not
/// finite are left out.
[[nodiscard]] std::string figure_table(const Figure& figure, FigureSize size, const PanelStamps& stamps,
                                       std::span<const MeasuredValue> values,
                                       std::span<const DrawnCurves> curves);

}  // namespace vrc
