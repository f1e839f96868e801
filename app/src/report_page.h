// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include "report_figure.h"

namespace vrc {

/// One HTML page that holds everything: the figures' texts, tables and plots, their pictures and records,
/// and the script that shows them. Reads the pictures, one at a time. Throws InputError when one cannot be
/// used or differs in size from others of its group.
[[nodiscard]] std::string report_page(std::span<const ReportFigure> figures);

}  // namespace vrc
