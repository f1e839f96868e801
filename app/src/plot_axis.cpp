// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace vrc {
namespace {

constexpr double kMostLabels = 10.0;
constexpr double kFewDecades = 1.5;
constexpr double kSlack = 1e-9;  // of rounding, in steps

std::string power_of_ten(int exponent) {
  return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}{}</tspan>", exponent < 0 ? "\u2212" : "",
                     std::abs(exponent));
}

/// "0.02", "500", or with a power of ten where that is shorter.
std::string round_number(int digit, int exponent) {
  if (exponent >= -3 && exponent <= 4) return fmt::format("{:g}", digit * std::pow(10.0, exponent));
  return digit == 1 ? power_of_ten(exponent) : fmt::format("{}\u00b7{}", digit, power_of_ten(exponent));
}

bool is_round(int digit) { return digit == 1 || digit == 2 || digit == 5; }

/// The logarithm of the next 1, 2 or 5 times a power of ten, at or below it (`up` false) or at or above it.
double round_logarithm(double logarithm, bool up) {
  const std::array candidates = {0.0, std::log10(2.0), std::log10(5.0), 1.0};
  const double decade = std::floor(logarithm + kSlack), rest = logarithm - decade;
  double result = up ? candidates.back() : candidates.front();
  for (const double c : candidates) {
    if (up && c >= rest - kSlack) result = std::min(result, c);
    if (!up && c <= rest + kSlack) result = std::max(result, c);
  }
  return decade + result;
}

/// 1, 2 or 5 times a power of ten, four to nine of which span `range`.
double round_step(double range) {
  const double decade = std::pow(10.0, std::floor(std::log10(range / 4.0)));
  for (const double digit : {5.0, 2.0}) {
    if (range / 4.0 >= digit * decade) return digit * decade;
  }
  return decade;
}

}  // namespace

PlotAxis::PlotAxis(double least, double most, double begin, double end)
    : begin_(begin), end_(end), logarithmic_(least > 0.0) {
  if (logarithmic_)
    divide_decades(std::log10(least), std::log10(most));
  else
    divide_evenly(least, most);
}

double PlotAxis::at(double value) const { return place(logarithmic_ ? std::log10(value) : value); }

double PlotAxis::place(double position) const {
  return begin_ + (end_ - begin_) * (position - low_) / (high_ - low_);
}

void PlotAxis::divide_decades(double least, double most) {
  low_ = round_logarithm(least, false);
  high_ = round_logarithm(most, true);
  if (high_ < low_ + kSlack) high_ = round_logarithm(low_ + 2.0 * kSlack, true);
  const bool few = high_ - low_ < kFewDecades;
  const int first = static_cast<int>(std::floor(low_ + kSlack)),
            last = static_cast<int>(std::floor(high_ + kSlack));
  const int stride = std::max(1, static_cast<int>(std::ceil((last - first) / kMostLabels)));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int digit = 1; digit < 10; ++digit) {
      const double logarithm = exponent + std::log10(digit);
      if (logarithm < low_ - kSlack || logarithm > high_ + kSlack) continue;
      std::string label;
      if (few && is_round(digit)) label = round_number(digit, exponent);
      if (!few && digit == 1 && (exponent - first) % stride == 0) label = power_of_ten(exponent);
      if (!label.empty() || stride <= 1) ticks_.push_back({place(logarithm), std::move(label)});
    }
  }
}

void PlotAxis::divide_evenly(double least, double most) {
  const double step = round_step(std::max(most - least, 1e-12 * std::max(std::abs(least), 1.0)));
  low_ = step * std::floor(least / step + kSlack);
  high_ = std::max(low_ + step, step * std::ceil(most / step - kSlack));
  for (double value = low_; value <= high_ + 0.5 * step; value += step)
    ticks_.push_back({place(value), fmt::format("{:g}", std::abs(value) < kSlack * step ? 0.0 : value)});
}

}  // namespace vrc
