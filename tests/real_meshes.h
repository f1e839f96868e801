// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

namespace vrc::test {

/// OBJ and PLY meshes from outside the repository: of shared/models beside it, else of Debian's
/// glmark2-data; none where both are absent.
inline std::vector<std::filesystem::path> real_meshes() {
  std::vector<std::filesystem::path> paths;
  for (const char* folder : {VRC_SOURCE_DIR "/../shared/models", "/usr/share/glmark2/models"}) {
    std::error_code absent;
    for (const auto& entry : std::filesystem::directory_iterator(folder, absent)) {
      if (entry.path().extension() == ".obj" || entry.path().extension() == ".ply")
        paths.push_back(entry.path());
    }
    if (!paths.empty()) break;
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace vrc::test
