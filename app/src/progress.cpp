// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

namespace vrc {
namespace {

constexpr double kBarInterval = 0.1;    // seconds
constexpr double kLineInterval = 10.0;  // seconds
constexpr std::size_t kBarWidth = 24;
constexpr double kSecondsBeforeEstimate = 0.5;

double clean_fraction(double fraction) {
  return std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
}

std::string bar(double fraction) {
  const auto filled = static_cast<std::size_t>(std::lround(fraction * static_cast<double>(kBarWidth)));
  return std::string(filled, '#') + std::string(kBarWidth - filled, '-');
}

/// What follows the phase: "54%, 1.20 k records, 3.40 M rays/s, 12 s left".
std::string figures(const ProgressUpdate& update, double seconds) {
  const double fraction = clean_fraction(update.fraction);
  std::string text = fmt::format("{:3.0f}%", std::floor(100.0 * fraction));
  if (update.records > 0)
    text += fmt::format(", {} records", short_count(static_cast<double>(update.records)));
  if (update.rays > 0 && seconds > 0.0) {
    text += fmt::format(", {}rays/s", short_count(static_cast<double>(update.rays) / seconds));
  }
  if (fraction > 0.0 && fraction < 1.0 && seconds > kSecondsBeforeEstimate) {
    text += fmt::format(", {} left", short_time(seconds * (1.0 - fraction) / fraction));
  }
  return text;
}

}  // namespace

ProgressStyle progress_style_of_stderr() {
  return ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
}

int terminal_columns() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

ProgressDisplay::ProgressDisplay(std::ostream& out, ProgressStyle style, Clock clock, int columns)
    : out_(out),
      style_(style),
      clock_(std::move(clock)),
      columns_(static_cast<std::size_t>(std::max(20, columns))) {}

void ProgressDisplay::update(const ProgressUpdate& update) {
  if (style_ == ProgressStyle::kNone) return;
  const double now = clock_();
  if (update.phase != phase_) begin_phase(update.phase, now);
  if (style_ == ProgressStyle::kBar) {
    draw_bar(update, now);
  } else {
    write_line(update, now);
  }
}

void ProgressDisplay::begin_phase(std::string_view phase, double now) {
  clear();
  phase_ = phase;
  phase_start_ = now;
  last_shown_ = now;
  if (style_ == ProgressStyle::kLines) out_ << phase_ << "\n" << std::flush;
}

void ProgressDisplay::draw_bar(const ProgressUpdate& update, double now) {
  if (bar_visible_ && now - last_shown_ < kBarInterval) return;
  std::string line = fmt::format("{:<16} [{}] {}", phase_, bar(clean_fraction(update.fraction)),
                                 figures(update, now - phase_start_));
  // A line that wraps cannot be redrawn.
  if (line.size() >= columns_) line.resize(columns_ - 1);
  out_ << "\r" << line << "\x1b[K" << std::flush;
  bar_visible_ = true;
  last_shown_ = now;
}

void ProgressDisplay::write_line(const ProgressUpdate& update, double now) {
  if (now - last_shown_ < kLineInterval) return;
  out_ << phase_ << ": " << figures(update, now - phase_start_) << "\n" << std::flush;
  last_shown_ = now;
}

void ProgressDisplay::clear() {
  if (bar_visible_) out_ << "\r\x1b[K" << std::flush;
  bar_visible_ = false;
}

std::string short_count(double count) {
  constexpr std::array<const char*, 4> kUnits{"", "k", "M", "G"};
  if (count < 999.5) return fmt::format("{:.0f} ", count);
  std::size_t unit = 0;
  // 999.5 and more would print as four digits.
  while (count >= 999.5 && unit + 1 < kUnits.size()) {
    count /= 1000.0;
    ++unit;
  }
  const int decimals = count < 9.995 ? 2 : count < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f} {}", count, decimals, kUnits[unit]);
}

std::string short_time(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace vrc
