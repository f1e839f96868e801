// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

namespace vrc {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A display with a clock that the test turns.
struct Stage {
  explicit Stage(ProgressStyle style, int columns = 80)
      : display(
            out, style, [this] { return now; }, columns) {}
  std::size_t count(char c) const {
    const std::string text = out.str();
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), c));
  }

  std::ostringstream out;
  double now = 0.0;
  ProgressDisplay display;
};

TEST(Progress, OfStyleNoneSaysNothing) {
  Stage stage(ProgressStyle::kNone);
  stage.display.update({"render", 0.5, 1, 1});
  EXPECT_EQ(stage.out.str(), "");
}

TEST(Progress, InAPipeIsOneLineAPhaseAndOneEveryTenSeconds) {
  Stage stage(ProgressStyle::kLines);
  for (int i = 0; i < 25000; ++i) {
    stage.now = 1e-3 * i;
    stage.display.update({"place records", i / 25000.0, 0, 0});
  }
  EXPECT_EQ(stage.count('\n'), 3u);  // the start, then at 10 s and at 20 s
  stage.display.update({"render", 0.0, 0, 0});
  EXPECT_EQ(stage.count('\n'), 4u);
  EXPECT_THAT(stage.out.str(), testing::EndsWith("render\n"));
  EXPECT_THAT(stage.out.str(), Not(HasSubstr("\r")));
}

TEST(Progress, BarIsRedrawnAtMostTenTimesASecond) {
  Stage stage(ProgressStyle::kBar);
  for (int i = 0; i < 1000; ++i) {
    stage.now = 1e-3 * i;
    stage.display.update({"render", i / 1000.0, 0, 0});
  }
  EXPECT_LE(stage.count('\r'), 11u);
  EXPECT_GE(stage.count('\r'), 9u);
}

TEST(Progress, BarShowsPhaseRecordsRateAndTimeLeft) {
  Stage stage(ProgressStyle::kBar, 200);
  stage.display.update({"place records", 0.0, 0, 0});
  stage.now = 10.0;
  stage.display.update({"place records", 0.25, 2053, 34'000'000});
  EXPECT_THAT(stage.out.str(),
              testing::AllOf(HasSubstr("place records"), HasSubstr(" 25%"), HasSubstr("2.05 k records"),
                             HasSubstr("3.40 Mrays/s"), HasSubstr("30 s left")));
}

TEST(Progress, BarFitsTheTerminalAndIsRemovedAtTheEnd) {
  std::ostringstream out;
  {
    double now = 0.0;
    ProgressDisplay display(
        out, ProgressStyle::kBar, [&now] { return now; }, 40);
    now = 5.0;
    display.update({"a phase with a name that is much too long", 0.5, 123456, 123456789});
  }
  const std::string text = out.str();
  const std::size_t end = text.find("\x1b[K");
  ASSERT_NE(end, std::string::npos);
  EXPECT_LE(end, 40u);
  EXPECT_THAT(text, testing::EndsWith("\r\x1b[K"));
}

TEST(Progress, SurvivesFractionsThatAreNone) {
  Stage stage(ProgressStyle::kBar);
  stage.display.update({"render", std::numeric_limits<double>::quiet_NaN(), 0, 0});
  stage.now = 1.0;
  stage.display.update({"render", 7.0, 0, 0});
  EXPECT_THAT(stage.out.str(), testing::AllOf(HasSubstr("  0%"), HasSubstr("100%"), Not(HasSubstr("nan"))));
}

TEST(ShortText, CountsKeepThreeDigits) {
  EXPECT_EQ(short_count(0), "0 ");
  EXPECT_EQ(short_count(999), "999 ");
  EXPECT_EQ(short_count(999.7), "1.00 k");
  EXPECT_EQ(short_count(12345), "12.3 k");
  EXPECT_EQ(short_count(999'600), "1.00 M");
  EXPECT_EQ(short_count(4.56e9), "4.56 G");
  EXPECT_EQ(short_count(1e13), "10000 G");
}

TEST(ShortText, Times) {
  EXPECT_EQ(short_time(0.2), "1 s");
  EXPECT_EQ(short_time(185), "3:05");
  EXPECT_EQ(short_time(3723), "1:02:03");
}

}  // namespace
}  // namespace vrc
