// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace vrc {

struct PackedLayout {
  std::vector<Vec2> offset;  ///< Per rectangle: its lower left corner.
  Vec2 size = Vec2::Zero();  ///< Of the whole.
};

/// Places rectangles of the given sizes, unturned, on shelves of a roughly square sheet, the highest
/// first, with a small gap around each.
[[nodiscard]] PackedLayout pack_shelves(std::span<const Vec2> sizes);

}  // namespace vrc
