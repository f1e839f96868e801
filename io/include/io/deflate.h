// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace vrc {

/// The bytes as a zlib stream (RFC 1950), which browsers inflate by themselves. The same bytes give the
/// same stream.
[[nodiscard]] std::string deflated(std::string_view bytes);

}  // namespace vrc
