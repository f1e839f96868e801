// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "placement/record_maker.h"

namespace vrc {

/// Replaces each record's radiance by the weighted least-squares fit of its own gathered derivatives
/// and the values of its neighbours, all weighted by their measured variances. Noise in a record is
/// averaged with what surrounds it; a clean record stays as it is. Regions are kept.
void fit_jointly(std::vector<RadianceRecord>& records, const RegionRule& rule);

}  // namespace vrc
