// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/baselines.h"

namespace vrc {

CacheOptions baseline_options(Baseline baseline, const CacheOptions& budget) {
  if (baseline == Baseline::kNone) return budget;
  CacheOptions options = budget;
  options.strategy = Strategy::kViewDependent;
  options.metric = PlacementMetric::kSplitSphere;
  options.taylor_order = 1;
  options.glossy_glossy = false;
  options.gradient_share = 0.0;
  options.joint_fit = false;
  options.supersample_edges = false;
  options.hard_pixels = false;
  options.error_of_picture = false;
  switch (baseline) {
    case Baseline::kNone:
    case Baseline::kKrivanek:
      options.representation = Representation::kHarmonics;
      break;
    case Baseline::kWard:
      options.representation = Representation::kIrradiance;
      options.irradiance_derivatives = IrradianceDerivatives::kStrata;
      break;
    case Baseline::kSchwarzhaupt:
      options.representation = Representation::kIrradiance;
      options.irradiance_derivatives = IrradianceDerivatives::kTriangles;
      options.metric = PlacementMetric::kHessian;
      break;
  }
  return options;
}

}  // namespace vrc
