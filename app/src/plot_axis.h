// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace vrc {

/// A line of the grid behind a plot.
struct PlotTick {
  double at = 0.0;    ///< In the document.
  std::string label;  ///< Contents of an SVG text; "" for lines that only divide.
};

/// An axis between round numbers around what it shows: logarithmic if that is positive, otherwise linear.
/// Over less than a decade and a half, 1, 2 and 5 times powers of ten are labelled; over more, powers of ten.
class PlotAxis {
 public:
  /// From `least` to `most`, finite, which lie between `begin` and `end` of the document.
  PlotAxis(double least, double most, double begin, double end);

  [[nodiscard]] double at(double value) const;
  [[nodiscard]] const std::vector<PlotTick>& ticks() const { return ticks_; }

 private:
  void divide_decades(double least, double most);
  void divide_evenly(double least, double most);
  [[nodiscard]] double place(double position) const;

  double begin_, end_;
  double low_ = 0.0, high_ = 1.0;  ///< Values at the ends, or their logarithms.
  bool logarithmic_;
  std::vector<PlotTick> ticks_;
};

}  // namespace vrc
