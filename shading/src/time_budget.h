// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/run_control.h"
#include "core/timing.h"
#include "placement/place_records.h"

namespace vrc {

/// How carefully a picture is shaded, from all that was asked for down to what must be.
enum class ShadingEffort {
  kFull,
  kNoFurtherEdgeSamples,
  kOneLightSample,  ///< And no further samples at edges.
};

/// What a picture needs besides its records and their interpolation.
struct WorkBesideShading {
  double path_seconds = 0.0;  ///< Paths from the samples that no record reaches.
  double hard_pixels = 0.0;
  double seconds_per_ray = 0.0;  ///< Of hard pixels.
};

/// Tries on parts of a picture with the records there are.
class ShadingTrials {
 public:
  virtual ~ShadingTrials() = default;
  /// Time to shade the whole picture, but for the paths.
  virtual double seconds_with(ShadingEffort effort) = 0;
  /// With the latest effort.
  virtual WorkBesideShading beside() = 0;
};

struct TimedPlacement {
  double error = 0.0;              ///< Accepted, that the records were placed for.
  double finish_placing_by = 0.0;  ///< On the clock: samples that are open then stay so.
  ShadingEffort effort = ShadingEffort::kFull;
};

/// Covers the visible points with a coarse error, as far as the time goes, and lowers it step by step, until
/// the records have taken what the other work leaves of `seconds` on `clock`. The trials are made after the
/// first step.
[[nodiscard]] TimedPlacement cover_within_time(RecordPlacer& placer, double seconds, const PhaseTimer& clock,
                                               const RunControl& control, ShadingTrials& trials);

}  // namespace vrc
