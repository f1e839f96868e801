// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_equal_time.h"

#include <algorithm>
#include <cmath>

namespace vrc {
namespace {

constexpr int kMostRuns = 4;
constexpr double kCloseEnough = 0.06;  // of the time
constexpr double kMostChange = 16.0;   // of the number from run to run
constexpr int kPacket = 16;            // camera samples that are traced at once

double cpu_seconds_of(const RenderResult& result, bool placement_only) {
  double sum = 0.0;
  for (const PhaseTime& phase : result.stats.phases) {
    if (!placement_only || phase.name == "place records" || phase.name == "fit records")
      sum += phase.cpu_seconds;
  }
  return sum;
}

}  // namespace

double render_cpu_seconds(const RenderResult& result) { return cpu_seconds_of(result, false); }

TimedRun run_for_time(const EqualTime& equal, double cpu_seconds,
                      const std::function<SceneRun(int)>& render) {
  const bool records = equal.option == "--records";
  TimedRun best;
  double best_miss = std::numeric_limits<double>::infinity();
  int number = equal.first;
  for (int i = 0; i < kMostRuns; ++i) {
    SceneRun run = render(number);
    const double seconds = render_cpu_seconds(run.result);
    // Shading takes the same time with any number of records.
    const double growing = std::max(cpu_seconds_of(run.result, records), 1e-6);
    const double miss = std::abs(std::log(seconds / cpu_seconds));
    if (miss < best_miss) {
      best_miss = miss;
      best = {std::move(run), number};
    }
    if (miss < kCloseEnough) break;
    const double factor = 1.0 + (cpu_seconds - seconds) / growing;
    int next = static_cast<int>(std::lround(number * std::clamp(factor, 1.0 / kMostChange, kMostChange)));
    if (!records && next > kPacket) next = kPacket * static_cast<int>(std::lround(next / double{kPacket}));
    next = std::max(next, 1);
    if (next == number) break;
    number = next;
  }
  return best;
}

}  // namespace vrc
