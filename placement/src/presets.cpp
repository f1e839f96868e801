// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/presets.h"

namespace vrc {

CacheOptions paper_preset(const CacheOptions& budget) {
  CacheOptions options = budget;
  // Placement [Zhao 3, 4.1, 5].
  options.sampler = Sampler::kImage;
  options.strategy = Strategy::kViewDependent;
  options.metric = PlacementMetric::kHessian;
  options.gradient_share = 0.0;
  options.dark_share = 0.0;
  // What records hold [Zhao 4.2, 4.3].
  options.representation = Representation::kHybrid;
  options.harmonics_rule = HarmonicsRule::kPaper;
  options.harmonics_rays = HarmonicsRays::kUniform;
  options.glossy_glossy = true;
  options.total_derivative = false;
  options.occlusion_aware = false;
  options.guided = false;
  // Interpolation [Zhao 4.4, 5].
  options.taylor_order = 2;
  options.joint_weight = false;
  options.max_normal_deviation = 0.1;
  options.blend_support = 1.0;
  options.joint_fit = false;
  options.hard_pixels = false;
  options.error_of_picture = false;
  options.supersample_edges = false;
  return options;
}

}  // namespace vrc
