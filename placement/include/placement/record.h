// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/jet2.h"
#include "placement/gather.h"
#include "placement/site_curvature.h"
#include "placement/surface_reach.h"
#include "placement/valid_region.h"

namespace vrc {

/// A cached estimate of outgoing radiance: where it is, what it knows, how far it may be used.
struct RadianceRecord {
  RecordSite site;
  RadianceEstimate estimate;     ///< As gathered; never changed afterwards.
  std::array<Jet2, 3> radiance;  ///< What is interpolated: limited and fitted. In the site's frame.
  ValidRegion region;
  SiteCurvature curvature;
  double clamp_factor = 1.0;  ///< < 1: how much the crease limit reduced the derivatives.
};

/// What each record reaches over its surface with its region widened `support` times.
[[nodiscard]] std::vector<SurfaceReach> reaches_of(const SceneCharts& charts,
                                                   std::span<const RadianceRecord> records, double support);

}  // namespace vrc
