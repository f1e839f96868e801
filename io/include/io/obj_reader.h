// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/polygon_soup.h"

namespace vrc {

/// A Wavefront OBJ file: its polygons and the names that they use.
struct ObjFile {
  PolygonSoup soup;                                       ///< face_material indexes `material_names`.
  std::vector<std::string> material_names;                ///< By first use; "" for faces before any usemtl.
  std::vector<std::filesystem::path> material_libraries;  ///< As written, resolved against the file's folder.
  std::vector<std::string> warnings;  ///< What was left out (points, lines, free-form surfaces).
};

/// Throws InputError with file and line on any malformed statement, non-finite number or index out
/// of range: a mesh is whole or not at all.
[[nodiscard]] ObjFile read_obj(const std::filesystem::path& path);

}  // namespace vrc
