// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace vrc {

// The files of app/report, made a part of the program by cmake/EmbedText.cmake.

/// The page with the words {{title}}, {{version}}, {{style}}, {{contents}}, {{data}} and {{script}} to be
/// replaced.
[[nodiscard]] std::string_view page_template();
[[nodiscard]] std::string_view page_style();
[[nodiscard]] std::string_view page_script();

}  // namespace vrc
