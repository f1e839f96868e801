// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/run_control.h"
#include "placement/place_records.h"

namespace vrc {

/// Tries what a picture is like with the records there are.
class ErrorTrial {
 public:
  virtual ~ErrorTrial() = default;
  /// Estimated relative error of the picture, once its hard pixels are gathered for `error`.
  virtual double relative_error(double error) = 0;
};

/// Covers the visible points with records for more than the accepted error, since a picture's is less than
/// that of its records, and for lower ones until the picture's error is expected to be the accepted one.
/// Returns the error that the records were placed for.
[[nodiscard]] double cover_within_error(RecordPlacer& placer, double accepted, const RunControl& control,
                                        ErrorTrial& trial);

}  // namespace vrc
