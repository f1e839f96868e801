// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/image.h"
#include "io/display.h"
#include "stats_json.h"

namespace vrc {

/// Writes a picture of a run: .png as `display` says, anything else as EXR with what `report` says of the run
/// in its header. Throws InputError.
void write_picture(const std::filesystem::path& path, const Image& image, const Display& display,
                   const RunReport& report);

}  // namespace vrc
