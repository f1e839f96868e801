// SPDX-License-Identifier: GPL-3.0-or-later
#include "error_goal.h"

#include <algorithm>

namespace vrc {
namespace {

// What records are placed for at first, over the accepted error.
constexpr double kFirst = 2.0;
// Expected error over the accepted one: what is good enough, and what the next records aim at.
constexpr double kGoodEnough = 1.15, kAim = 0.95;
constexpr double kLargestStep = 3.0;
constexpr int kMostSteps = 3;

}  // namespace

double cover_within_error(RecordPlacer& placer, double accepted, const RunControl& control,
                          ErrorTrial& trial) {
  double error = kFirst * accepted;
  placer.cover(error);
  for (int step = 0; step < kMostSteps && !control.stopped(); ++step) {
    const double expected = trial.relative_error(error);
    if (expected < kGoodEnough * accepted) break;
    error /= std::min(expected / (kAim * accepted), kLargestStep);
    placer.cover(error);
  }
  return error;
}

}  // namespace vrc
