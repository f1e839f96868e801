// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/image.h"
#include "io/display.h"

namespace vrc {

/// String metadata of an EXR header ("vrc:version", "vrc:scene", ...).
using ImageMetadata = std::map<std::string, std::string>;

/// 32-bit float OpenEXR with all channels. Written to a temporary name, then renamed.
/// Throws InputError when the path cannot be written.
void write_exr(const std::filesystem::path& path, const Image& image, const ImageMetadata& metadata = {});

/// 8-bit sRGB PNG of the channels R, G, B (or the first three) as `displayed`; pixels with NaN are magenta.
void write_png(const std::filesystem::path& path, const Image& image, const Display& display = {});

/// Reads any image that OpenImageIO reads, as float, with its channel names.
[[nodiscard]] Image read_image(const std::filesystem::path& path);

}  // namespace vrc
