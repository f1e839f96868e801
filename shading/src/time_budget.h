// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "core/run_control.h"
#include "core/timing.h"
#include "placement/place_records.h"

namespace vrc {

/// What a picture needs besides its records.
struct WorkAfterRecords {
  double shading_seconds = 0.0;
  double hard_pixels = 0.0;
  double seconds_per_ray = 0.0;  ///< Of hard pixels.
};

/// Covers the visible points with a coarse error and lowers it step by step, until the records have taken
/// what the other work leaves of `seconds` on `clock`. `measure` is called after the first step. Returns the
/// last error.
[[nodiscard]] double cover_within_time(RecordPlacer& placer, double seconds, const PhaseTimer& clock,
                                       const RunControl& control,
                                       const std::function<WorkAfterRecords()>& measure);

}  // namespace vrc
