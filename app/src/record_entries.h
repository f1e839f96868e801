// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "io/record_map.h"
#include "placement/radiance_cache.h"

namespace vrc {

/// What a record map shows of the records of `cache`, in their order.
[[nodiscard]] std::vector<RecordMapEntry> record_entries(const RadianceCache& cache);

/// The ellipses of the records' valid regions on the surface, lifted a little to be seen before it.
[[nodiscard]] std::vector<EllipseTessellation> record_tessellations(const RadianceCache& cache);

}  // namespace vrc
