// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace vrc {

inline constexpr int kGlyphWidth = 5;
inline constexpr int kGlyphHeight = 7;
inline constexpr int kGlyphAdvance = 6;  ///< From one character to the next.

/// Whether the character is inked at column x, row y from the top. Unknown characters are blank.
[[nodiscard]] bool glyph_has_ink(char character, int x, int y);

}  // namespace vrc
