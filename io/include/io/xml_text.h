// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace vrc {

/// Text as it stands in an XML document, between tags or in double quotes.
[[nodiscard]] std::string xml_escaped(const std::string& text);

}  // namespace vrc
