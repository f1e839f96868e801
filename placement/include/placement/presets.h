// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "placement/cache_options.h"

namespace vrc {

/// The options that make the cache work as the paper says [Zhao 4-5]; error, number of records, gather rays
/// and order of the harmonics are those of `budget`. What each line is and what no option undoes:
/// docs/decisions/010.
[[nodiscard]] CacheOptions paper_preset(const CacheOptions& budget);

}  // namespace vrc
