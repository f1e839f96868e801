// SPDX-License-Identifier: GPL-3.0-or-later
#include "time_budget.h"

#include <algorithm>

#include "hard_pixels.h"

namespace vrc {
namespace {

constexpr double kFirstError = 0.2, kLeastError = 1e-4;
// What as much work as the first round's costs afterwards, over what that took: it had to look at the
// picture, and many of its records lie where any error needs them. A first step, of at most so much, tells
// better.
constexpr double kFurtherWork = 0.3, kTrialStep = 1.5;
constexpr double kSlack = 0.05;             // of the time, for what takes longer than planned
constexpr double kFinishing = 2.0;          // making a cache of the records and shading, over shading alone
constexpr double kMostForHardPixels = 0.3;  // of the time
// A round that would take more than this, over the time so far, is halved.
constexpr double kHalvedRound = 0.5;
constexpr double kWholeRound = 0.9;  // of what is left, for the last one
// By how much a round may lower the error, what is not worth one, and how finely that is sought.
constexpr double kLargestStep = 8.0, kSmallestStep = 1.02, kStep = 1.01;

}  // namespace

double cover_within_time(RecordPlacer& placer, double seconds, const PhaseTimer& clock,
                         const RunControl& control, const std::function<WorkAfterRecords()>& measure) {
  double error = kFirstError;
  placer.cover(error);
  double work = 1.0;  // the first round's
  double per_work = kFurtherWork * clock.elapsed().seconds;
  const WorkAfterRecords after = measure();
  while (!control.stopped() && error > kLeastError) {
    const double now = clock.elapsed().seconds;
    const auto left_with = [&](double e) {
      return (1.0 - kSlack) * seconds - now - kFinishing * after.shading_seconds -
             std::min(after.hard_pixels * HardPixels::rays_per_pixel(e) * after.seconds_per_ray,
                      kMostForHardPixels * seconds);
    };
    // Half of what is left, unless that is little: what a step costs is known better afterwards.
    const double share = left_with(error) > kHalvedRound * now ? 0.5 : kWholeRound;
    const auto fits = [&](double e) {
      return per_work * work * (placer.relative_work(e) - 1.0) < share * left_with(e);
    };
    const double largest_step = work > 1.0 ? kLargestStep : kTrialStep;
    double step = 1.0;
    while (step < largest_step && fits(error / (step * kStep))) step *= kStep;
    if (step < kSmallestStep) break;
    error /= step;
    const double factor = placer.relative_work(error);
    placer.cover(error);
    per_work = (clock.elapsed().seconds - now) / (work * (factor - 1.0));
    work *= factor;
  }
  return error;
}

}  // namespace vrc
