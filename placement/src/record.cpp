// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/record.h"

#include "core/parallel.h"

namespace vrc {

std::string_view name_of(HarmonicsReason reason) {
  constexpr std::array<std::string_view, kHarmonicsReasons> kNames = {"none", "always", "turns",
                                                                      "replaces-many", "narrow"};
  return kNames[static_cast<std::size_t>(reason)];
}

std::vector<SurfaceReach> reaches_of(const SceneCharts& charts, std::span<const RadianceRecord> records,
                                     double support) {
  std::vector<SurfaceReach> reaches(records.size());
  parallel_for(records.size(), [&](std::size_t i) {
    reaches[i] = reach_over_surface(charts, records[i].site.point, turned_widest(records[i].region), support);
  });
  return reaches;
}

}  // namespace vrc
