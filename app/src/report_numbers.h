// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace vrc {

/// Three digits as a reader likes them: 0.0123, 18, 13 100, 1.2 x 10^-4 (with the signs and superscripts of
/// typography, in UTF-8).
[[nodiscard]] std::string readable(double value);

/// All digits, in groups of three.
[[nodiscard]] std::string readable(std::int64_t value);

/// What a number of a panel is called: "CPU seconds" for "cpu_seconds".
[[nodiscard]] std::string title_of(const std::string& number);

}  // namespace vrc
