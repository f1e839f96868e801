// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "placement/record_maker.h"
#include "placement/scene_charts.h"

namespace vrc {

/// Replaces each record's radiance by the weighted least-squares fit of its own gathered derivatives
/// and the values of its neighbours, all weighted by their measured variances. Noise in a record is
/// averaged with what surrounds it; a clean record stays as it is. Regions are kept. Neighbours are those
/// that the record reaches over its surface. Records of spherical harmonics stay as they are; `reaches` are
/// those of the records at kFitSupport or more.
void fit_jointly(const SceneCharts& charts, std::vector<RadianceRecord>& records,
                 std::span<const SurfaceReach> reaches, const RegionRule& rule);

/// Neighbours farther than this multiple of a record's radii do not count.
inline constexpr double kFitSupport = 2.5;

}  // namespace vrc
