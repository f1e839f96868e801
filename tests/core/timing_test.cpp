// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/timing.h"

#include <gtest/gtest.h>

#include <vector>

namespace vrc {
namespace {

/// Works until this process has used `seconds` more of processor time.
void work(double seconds) {
  const double end = process_cpu_seconds() + seconds;
  while (process_cpu_seconds() < end) {
  }
}

TEST(Timing, PhaseTimesIncreaseWithWork) {
  const PhaseTimer timer("gather");
  const PhaseTime begin = timer.elapsed();
  EXPECT_EQ(begin.name, "gather");
  EXPECT_GE(begin.seconds, 0.0);
  EXPECT_GE(begin.cpu_seconds, 0.0);
  work(0.02);
  const PhaseTime end = timer.elapsed();
  EXPECT_GT(end.seconds, begin.seconds);
  EXPECT_GE(end.cpu_seconds, begin.cpu_seconds + 0.02);
}

TEST(Timing, TimersStartAtTheirConstruction) {
  const PhaseTimer first("first");
  work(0.02);
  const PhaseTimer second("second");
  const double later = second.elapsed().cpu_seconds;
  EXPECT_GT(first.elapsed().cpu_seconds, later);
}

TEST(Timing, PeakMemoryGrowsWithUse) {
  const std::size_t before = peak_memory_bytes();
  EXPECT_GT(before, std::size_t{1} << 20);
  // Larger than everything resident so far, so the peak has to rise.
  std::vector<char> block(before + (std::size_t{16} << 20), 1);
  EXPECT_GT(block[block.size() / 2], 0);
  EXPECT_GE(peak_memory_bytes(), block.size());
}

}  // namespace
}  // namespace vrc
