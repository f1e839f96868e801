// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/types.h"

namespace vrc {

struct CropWindow;

/// Limits of a number, both allowed.
template <typename T>
struct NumberRange {
  T low;
  T high;
};

/// The whole of `text` as a number of the range; nothing for anything else, NaN included.
template <typename T>
[[nodiscard]] std::optional<T> parse_number(std::string_view text, const NumberRange<T>& range) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(value >= range.low && value <= range.high)) return std::nullopt;
  return value;
}

/// Splits at every `separator`; n separators give n + 1 parts.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

/// "WxH", both in [1, 16384].
[[nodiscard]] std::optional<std::pair<int, int>> parse_size(std::string_view text);
/// "x,y,z", finite.
[[nodiscard]] std::optional<Vec3> parse_vec3(std::string_view text);
/// "x0,y0,x1,y1" with 0 <= x0 < x1 and 0 <= y0 < y1.
[[nodiscard]] std::optional<CropWindow> parse_crop(std::string_view text);

/// Declares an option of one argument that `read` takes; `read` returns false to reject it, and the
/// user is told `expected` ("a whole number from 1 to 16").
CLI::Option* add_value(CLI::App& app, const std::string& names, const std::string& type_name,
                       const std::string& description, const std::string& expected,
                       std::function<bool(const std::string&)> read);

/// Declares a number, `Target` being T or std::optional<T>. The help shows `default_text` or, when that
/// is empty, the present value of `target` as the default.
template <typename T, typename Target>
CLI::Option* add_number(CLI::App& app, const std::string& names, Target& target, NumberRange<T> range,
                        const std::string& description, const std::string& default_text = {}) {
  constexpr bool kWhole = std::is_integral_v<T>;
  const std::string expected =
      fmt::format("a {}number from {} to {}", kWhole ? "whole " : "", range.low, range.high);
  CLI::Option* option = add_value(app, names, kWhole ? "N" : "X", description, expected,
                                  [&target, range](const std::string& text) {
                                    const std::optional<T> value = parse_number<T>(text, range);
                                    if (value) target = *value;
                                    return value.has_value();
                                  });
  if constexpr (std::is_same_v<T, Target>) {
    option->default_str(default_text.empty() ? fmt::format("{}", target) : default_text);
  } else if (!default_text.empty()) {
    option->default_str(default_text);
  }
  return option;
}

/// Declares a choice among words; the first one is the default.
template <typename Enum>
CLI::Option* add_choice(CLI::App& app, const std::string& names, Enum& target,
                        std::vector<std::pair<std::string, Enum>> words, const std::string& description) {
  std::string list;
  for (const auto& [word, value] : words) list += (list.empty() ? "" : "|") + word;
  const std::string first = words.front().first;
  CLI::Option* option = add_value(app, names, list, description, "one of " + list,
                                  [&target, words = std::move(words)](const std::string& text) {
                                    for (const auto& [word, value] : words) {
                                      if (word != text) continue;
                                      target = value;
                                      return true;
                                    }
                                    return false;
                                  });
  return option->default_str(first);
}

}  // namespace vrc
