// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "io/display.h"

namespace CLI {
class App;
}

namespace vrc {

/// --exposure and --tonemap; `what` begins their descriptions: "PNG files are". An empty group is the
/// command's own.
void declare_display(CLI::App& command, Display& display, const std::string& what, const std::string& group);

}  // namespace vrc
