// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "geometry/polygon_soup.h"

namespace vrc {

/// Reads a PLY mesh: ascii, binary_little_endian or binary_big_endian; any order of elements and
/// properties; extra elements and properties are skipped; polygons by `vertex_indices` or
/// `vertex_index`, or triangle strips (`tristrips`); normals `nx ny nz`; texture coordinates
/// `s t`, `u v` or `texture_u texture_v`.
/// Throws InputError (with the line for header and ascii bodies) on anything malformed.
[[nodiscard]] PolygonSoup read_ply(const std::filesystem::path& path);

}  // namespace vrc
