// SPDX-License-Identifier: GPL-3.0-or-later
#include "report_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace vrc {
namespace {

constexpr const char* kThinSpace = "\u202f";
constexpr const char* kMinus = "\u2212";

std::string grouped(const std::string& digits) {
  if (digits.size() <= 4) return digits;
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += kThinSpace;
    text += digits[i];
  }
  return text;
}

std::string superscript(int number) {
  constexpr std::array kDigits = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                  "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string text = number < 0 ? "\u207b" : "";
  for (const char c : std::to_string(std::abs(number))) text += kDigits[static_cast<std::size_t>(c - '0')];
  return text;
}

std::string readable_magnitude(double value) {
  if (value == 0.0) return "0";
  const std::string scientific = fmt::format("{:.2e}", value);  // "1.20e-04"
  const std::size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));
  if (exponent >= 6 || exponent < -3) {
    std::string mantissa = scientific.substr(0, e);
    while (mantissa.back() == '0') mantissa.pop_back();
    if (mantissa.back() == '.') mantissa.pop_back();
    return mantissa + kThinSpace + "\u00d7" + kThinSpace + "10" + superscript(exponent);
  }
  if (exponent >= 2) return grouped(fmt::format("{:.0f}", value));
  return fmt::format("{:.{}f}", value, 2 - exponent);
}

}  // namespace

std::string readable(double value) {
  return (value < 0.0 ? kMinus : "") + readable_magnitude(std::abs(value));
}

std::string readable(std::int64_t value) {
  const std::string digits = std::to_string(value);
  return value < 0 ? kMinus + grouped(digits.substr(1)) : grouped(digits);
}

std::string title_of(const std::string& number) {
  static const std::map<std::string, std::string> kTitles{{"cpu_seconds", "CPU seconds"},
                                                          {"gather_rays", "rays a gather"},
                                                          {"relative_rms", "relative RMS error"},
                                                          {"relmse", "relMSE"},
                                                          {"ssim", "SSIM"}};
  const auto known = kTitles.find(number);
  if (known != kTitles.end()) return known->second;
  std::string title = number;
  std::ranges::replace(title, '_', ' ');
  return title;
}

}  // namespace vrc
