// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/presets.h"

#include <gtest/gtest.h>

namespace vrc {
namespace {

TEST(PaperPreset, IsWhatThePaperSays) {
  const CacheOptions o = paper_preset({});
  EXPECT_EQ(o.strategy, Strategy::kViewDependent);
  EXPECT_EQ(o.metric, PlacementMetric::kHessian);
  EXPECT_EQ(o.gradient_share, 0.0);
  EXPECT_EQ(o.dark_share, 0.0);
  EXPECT_EQ(o.representation, Representation::kHybrid);
  EXPECT_EQ(o.harmonics_rule, HarmonicsRule::kPaper);
  EXPECT_EQ(o.harmonics_rays, HarmonicsRays::kUniform);
  EXPECT_TRUE(o.glossy_glossy);
  EXPECT_FALSE(o.total_derivative);
  EXPECT_FALSE(o.occlusion_aware);
  EXPECT_FALSE(o.guided);
  EXPECT_EQ(o.taylor_order, 2);
  EXPECT_FALSE(o.joint_weight);
  EXPECT_EQ(o.max_normal_deviation, 0.1);
  EXPECT_EQ(o.blend_support, 1.0);
  EXPECT_FALSE(o.joint_fit);
  EXPECT_FALSE(o.hard_pixels);
  EXPECT_FALSE(o.error_of_picture);
}

TEST(PaperPreset, KeepsWhatTheUserMaySpend) {
  CacheOptions budget;
  budget.error = 0.2;
  budget.records = 77;
  budget.gather_rays = 8192;
  budget.harmonics_order = 10;
  const CacheOptions o = paper_preset(budget);
  EXPECT_EQ(o.error, 0.2);
  EXPECT_EQ(o.records, 77);
  EXPECT_EQ(o.gather_rays, 8192);
  EXPECT_EQ(o.harmonics_order, 10);
}

}  // namespace
}  // namespace vrc
