// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

#include "core/run_control.h"

namespace vrc {

enum class ProgressStyle {
  kNone,
  kBar,   ///< A terminal: one line, redrawn at most ten times a second.
  kLines  ///< A pipe or file: a line where a phase begins, then at most one every ten seconds.
};

/// kBar when standard error is a terminal, else kLines.
[[nodiscard]] ProgressStyle progress_style_of_stderr();

/// Shows how far a computation is. Not for use from several threads at once.
class ProgressDisplay {
 public:
  /// Seconds that only ever rise.
  using Clock = std::function<double()>;

  ProgressDisplay(std::ostream& out, ProgressStyle style, Clock clock, int columns = 80);
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;
  ~ProgressDisplay() { clear(); }

  void update(const ProgressUpdate& update);
  /// Removes the bar, so that other lines can follow.
  void clear();

 private:
  void begin_phase(std::string_view phase, double now);
  void draw_bar(const ProgressUpdate& update, double now);
  void write_line(const ProgressUpdate& update, double now);

  std::ostream& out_;
  ProgressStyle style_;
  Clock clock_;
  std::size_t columns_;
  std::string phase_;
  double phase_start_ = 0.0;
  double last_shown_ = 0.0;
  bool bar_visible_ = false;
};

/// Width of the terminal of standard error, or 80.
[[nodiscard]] int terminal_columns();

/// "950", "12.3 k", "4.56 M", "7.89 G".
[[nodiscard]] std::string short_count(double count);

/// "12 s", "3:05", "1:02:03".
[[nodiscard]] std::string short_time(double seconds);

}  // namespace vrc
