// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace vrc {

/// The version of the project in the top CMakeLists.txt; a test compares the two.
inline constexpr std::string_view kVersion = "0.1.0";

}  // namespace vrc
