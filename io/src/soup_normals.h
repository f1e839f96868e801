// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "geometry/polygon_soup.h"

namespace vrc {

/// Makes the normals of a file unit vectors. Zero normals carry no direction: they are removed, and
/// their corners get `kInvalidIndex`. Returns how many were removed.
std::size_t normalize_normals(PolygonSoup& soup);

}  // namespace vrc
