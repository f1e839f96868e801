// SPDX-License-Identifier: GPL-3.0-or-later
#include "time_budget.h"

#include <algorithm>
#include <limits>

#include "hard_pixels.h"

namespace vrc {
namespace {

constexpr double kFirstError = 0.2, kLeastError = 1e-4;
// What as much work as the first round's costs afterwards, over what that took: it had to look at the
// picture, and many of its records lie where any error needs them. A first step, of at most so much, tells
// better.
constexpr double kFurtherWork = 0.3, kTrialStep = 1.5;
constexpr double kSlack = 0.05;  // of the time, for what takes longer than planned
// Making a cache of the records and shading, over shading alone, and records for the samples between the
// points before.
constexpr double kFinishing = 1.3, kCoveringSamples = 0.7;
// Of the time, for hard pixels; less where records are so coarse that they gain more.
constexpr double kMostForHardPixels = 0.3, kMostBesideCoarse = 0.15, kCoarseError = 0.05;
constexpr double kLeastForHardPixels = 0.1;
constexpr double kMostForFirst = 0.35;    // of the time, for records until the other work is known
constexpr double kMostForShading = 0.55;  // of the time, before it is shaded with less effort
constexpr double kLeastCovered = 0.01;    // share of the points: what covering takes is not known before
constexpr double kSmallLoss = 0.1;        // of the time: by so much records may seem to spare none
// A round that would take more than this, over the time so far, is halved.
constexpr double kHalvedRound = 0.5;
constexpr double kWholeRound = 0.9;  // of what is left, for the last one
// By how much a round may lower the error, what is not worth one, and how finely that is sought.
constexpr double kLargestStep = 8.0, kSmallestStep = 1.1, kStep = 1.01;

}  // namespace

TimedPlacement cover_within_time(RecordPlacer& placer, double seconds, const PhaseTimer& clock,
                                 const RunControl& control, ShadingTrials& trials) {
  double error = kFirstError;
  const auto past = [&](double end) { return [&clock, end] { return clock.elapsed().seconds > end; }; };
  bool covered = placer.cover(error, past(kMostForFirst * seconds));
  double placing = clock.elapsed().seconds;
  // A picture without records everywhere is worse than one that is shaded with less effort.
  const double open = placer.open_share();
  const double covering = placing * open / std::max(1.0 - open, kLeastCovered);

  double finishing = 0.0;
  TimedPlacement result;
  for (const ShadingEffort effort :
       {ShadingEffort::kFull, ShadingEffort::kNoFurtherEdgeSamples, ShadingEffort::kOneLightSample}) {
    result.effort = effort;
    const bool covers_samples = covered && effort == ShadingEffort::kFull;
    const double shading = trials.seconds_with(effort);
    finishing = (kFinishing + (covers_samples ? kCoveringSamples : 0.0)) * shading;
    result.finish_placing_by =
        covers_samples ? (1.0 - kSlack - kLeastForHardPixels) * seconds - kFinishing * shading : 0.0;
    if (finishing < kMostForShading * seconds && placing + covering + finishing < seconds) break;
  }
  const WorkBesideShading beside = trials.beside();
  const auto placed_by = [&](double e) {
    return (1.0 - kSlack) * seconds - finishing -
           std::min(beside.hard_pixels * HardPixels::rays_per_pixel(e) * beside.seconds_per_ray,
                    (e < kCoarseError ? kMostForHardPixels : kMostBesideCoarse) * seconds);
  };
  if (!covered) {
    const double now = clock.elapsed().seconds;
    // The more is covered, the fewer paths there will be: records that spare more time than they take are
    // made in any case.
    double least_end = std::numeric_limits<double>::infinity();
    covered = placer.cover(error, [&] {
      const double end =
          clock.elapsed().seconds + finishing + beside.path_seconds * placer.open_share() / open;
      const bool saves = end < least_end + kSmallLoss * seconds;
      least_end = std::min(least_end, end);
      return end > (1.0 - kSlack) * seconds && !saves;
    });
    placing += clock.elapsed().seconds - now;
  }
  double work = 1.0;  // the first round's
  double per_work = kFurtherWork * placing;
  while (covered && !control.stopped() && error > kLeastError) {
    const double now = clock.elapsed().seconds;
    const auto left_with = [&](double e) { return placed_by(e) - now; };
    // Half of what is left, unless that is little: what a step costs is known better afterwards.
    const double share = left_with(error) > kHalvedRound * now ? 0.5 : kWholeRound;
    const auto fits = [&](double e) {
      return per_work * work * (placer.relative_work(e) - 1.0) < share * left_with(e);
    };
    const double largest_step = work > 1.0 ? kLargestStep : kTrialStep;
    double step = 1.0;
    while (step < largest_step && fits(error / (step * kStep))) step *= kStep;
    if (step < kSmallestStep) break;
    const double next = error / step;
    const double factor = placer.relative_work(next);
    if (!placer.cover(next, past(placed_by(next)))) {
      // Worse than expected. What was made serves the last error, too.
      placer.cover(error);
      break;
    }
    error = next;
    per_work = (clock.elapsed().seconds - now) / (work * (factor - 1.0));
    work *= factor;
  }
  result.error = error;
  return result;
}

}  // namespace vrc
