// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "figure_panel.h"

namespace vrc {

/// Makes a panel of PanelKind::kDerivatives from the files of `vrc derivatives`, which are made first unless
/// they are there.
[[nodiscard]] PanelStamp make_derivatives(const FigureGroup& group, const FigurePanel& panel,
                                          std::uint64_t scene_key, const PanelPlace& place,
                                          const std::atomic<bool>& stop);

}  // namespace vrc
