// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "report_figure.h"

namespace vrc {

/// Ours beside the paper's numbers, a row for each panel, as HTML; "" when there are none.
[[nodiscard]] std::string panel_table(const ReportGroup& group);

/// What was measured, what it must be and whether it is, as HTML; "" when nothing was.
[[nodiscard]] std::string measure_table(const std::vector<ReportMeasure>& measures);

}  // namespace vrc
