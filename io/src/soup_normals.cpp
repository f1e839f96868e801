// SPDX-License-Identifier: GPL-3.0-or-later
#include "soup_normals.h"

namespace vrc {

std::size_t normalize_normals(PolygonSoup& soup) {
  std::size_t zero_count = 0;
  for (Vec3& normal : soup.normals) {
    if (normal.isZero(0.0)) {
      ++zero_count;
    } else {
      normal = normal.stableNormalized();
    }
  }
  if (zero_count == 0) return 0;

  std::vector<std::uint32_t> new_index(soup.normals.size(), kInvalidIndex);
  std::vector<Vec3> kept;
  kept.reserve(soup.normals.size() - zero_count);
  for (std::size_t i = 0; i < soup.normals.size(); ++i) {
    if (soup.normals[i].isZero(0.0)) continue;
    new_index[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(soup.normals[i]);
  }
  soup.normals = std::move(kept);
  for (std::uint32_t& corner : soup.corner_normal) {
    if (corner != kInvalidIndex) corner = new_index[corner];
  }
  return zero_count;
}

}  // namespace vrc
