// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/record_factory.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "placement_support.h"

namespace vrc {
namespace {

CacheOptions options_of(Strategy strategy, Representation representation) {
  CacheOptions options;
  options.strategy = strategy;
  options.representation = representation;
  options.harmonics_order = 6;
  return options;
}

GatherOptions gather_options() {
  GatherOptions gather;
  gather.log2_rays = 13;
  return gather;
}

TEST(RecordFactory, BoundsAllDirectionsWhereTheViewDoesNotMatter) {
  // [Zhao eq. 6]: the metric of a view-independent strategy stays as the camera moves; the radiance
  // that a view-dependent one bounds does not.
  const Scene scene = test::load_scene("half_box.xml", 64, 64, {{"diffuse", "0"}});
  const SceneCharts charts(scene);
  RayCounts counts;
  for (const RecordSite& site : test::sites_at(scene, {{0.8, 0.6}, {0.2, 0.5}, {0.5, 0.8}})) {
    RecordSite moved = site;
    moved.to_camera += 0.5 * site.to_camera.norm() * site.frame.tangent;
    for (const Strategy strategy : {Strategy::kViewIndependent, Strategy::kViewIndependentOutgoing}) {
      const CacheOptions options = options_of(strategy, Representation::kAnalytic);
      const RecordFactory factory(charts, options);
      const RadianceRecord a = factory.make(site, gather_options(), {}, counts, GuideField(scene));
      const RadianceRecord b = factory.make(moved, gather_options(), {}, counts, GuideField(scene));
      const Jet2 &all_a = a.harmonics->all_directions, &all_b = b.harmonics->all_directions;
      EXPECT_GT(all_a.value, 0.0);
      EXPECT_NEAR(all_b.value, all_a.value, 0.02 * all_a.value);
      EXPECT_LT((all_b.hessian - all_a.hessian).norm(), 0.1 * all_a.hessian.norm());
      EXPECT_GT(std::abs(b.estimate.luminance.value - a.estimate.luminance.value),
                0.2 * a.estimate.luminance.value);
      EXPECT_EQ(a.harmonics->incident.count(), 0) << "only the radii need them";
    }
  }
}

TEST(RecordFactory, SumsAbsoluteHessians) {
  const Scene scene = test::load_scene("half_box.xml", 64, 64);
  const SceneCharts charts(scene);
  const CacheOptions options = options_of(Strategy::kViewIndependent, Representation::kHarmonics);
  const RecordFactory factory(charts, options);
  RayCounts counts;
  const RecordSite site = test::sites_at(scene, {{0.5, 0.8}}).at(0);
  const RadianceRecord record = factory.make(site, gather_options(), {}, counts, GuideField(scene));
  double norm = 0.0, largest = 0.0;
  const auto m = record.harmonics->incident.coefficients();
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    const auto entry = [&](int k) {
      return kLuminance[0] * static_cast<double>(m(k, j)) + kLuminance[1] * static_cast<double>(m(6 + k, j)) +
             kLuminance[2] * static_cast<double>(m(12 + k, j));
    };
    norm += std::abs(entry(0));
    largest += std::max(std::abs(entry(3)), std::abs(entry(5)));
  }
  const Jet2& all = record.harmonics->all_directions;
  EXPECT_NEAR(all.value, norm, 1e-6 * norm);
  EXPECT_GE(all.hessian.trace(), largest);
  EXPECT_GE(all.hessian.determinant(), 0.0);
  EXPECT_EQ(record.harmonics_reason, HarmonicsReason::kAlways);
}

TEST(RecordFactory, GivesHarmonicsWhereTheySaveRecords) {
  const Scene scene = test::load_scene("object_small_sphere.xml", 64, 64, {{"exponent", "20"}});
  const SceneCharts charts(scene);
  RayCounts counts;
  CacheOptions options = options_of(Strategy::kViewDependent, Representation::kHybrid);
  RegionRule rule;
  rule.options = &options;
  rule.picture_width = 64;
  rule.mean_luminance = 0.1;
  const RecordSite site = test::sites_at(scene, {{0.5, 0.5}}).at(0);
  ASSERT_GT(site.point.shape_operator.norm(), 0.0);
  const auto reason_at = [&](double epsilon) {
    const RecordFactory factory(charts, options);
    RadianceRecord record = factory.make(site, gather_options(), {}, counts, GuideField(scene));
    rule.epsilon = epsilon;
    factory.shape(record, rule, gather_options(), counts);
    EXPECT_EQ(record.harmonics != nullptr, record.uses_harmonics());
    return record.harmonics_reason;
  };
  EXPECT_EQ(reason_at(1e-9), HarmonicsReason::kNone) << "a small ellipse does not turn";
  options.records = 100;
  EXPECT_EQ(reason_at(1e-1), HarmonicsReason::kReplacesMany) << "few records are wanted";
  options.records = 0;
  options.harmonics_order = 24;
  EXPECT_EQ(reason_at(1e-4), HarmonicsReason::kNone) << "too dear for what they replace";
  options.harmonics_order = 28;  // dearer than all that a record could replace
  const auto reason_from = [&](double radii_per_pixel) {
    RecordSite far_site = site;
    far_site.pixel_length =
        radii_per_pixel /
        site.point.shape_operator.selfadjointView<Eigen::Lower>().eigenvalues().cwiseAbs().maxCoeff();
    const RecordFactory factory(charts, options);
    RadianceRecord record = factory.make(far_site, gather_options(), {}, counts, GuideField(scene));
    rule.epsilon = 1e-4;
    factory.shape(record, rule, gather_options(), counts);
    return record.harmonics_reason;
  };
  EXPECT_EQ(reason_from(1.0), HarmonicsReason::kNone) << "its pixels are gathered again";
  options.hard_pixels = false;
  EXPECT_EQ(reason_from(1.0), HarmonicsReason::kNarrow) << "seen from so far that its radius is a pixel";
  EXPECT_EQ(reason_from(0.3), HarmonicsReason::kNone);
  options.harmonics_rule = HarmonicsRule::kPaper;
  EXPECT_EQ(reason_at(1e-1), HarmonicsReason::kTurns);
}

TEST(RecordFactory, GathersOnceWhereHarmonicsAreSure) {
  const Scene scene = test::load_scene("object_small_sphere.xml", 64, 64, {{"exponent", "20"}});
  const SceneCharts charts(scene);
  CacheOptions options = options_of(Strategy::kViewDependent, Representation::kHybrid);
  options.gather_rays = 1 << 13;
  options.hard_pixels = false;
  RegionRule rule;
  rule.options = &options;
  rule.picture_width = 64;
  rule.mean_luminance = 0.1;
  rule.epsilon = 1e-9;
  RecordSite site = test::sites_at(scene, {{0.5, 0.5}}).at(0);
  site.pixel_length =
      1.0 / site.point.shape_operator.selfadjointView<Eigen::Lower>().eigenvalues().cwiseAbs().maxCoeff();
  const RecordFactory factory(charts, options);
  RayCounts counts;
  RadianceRecord record = factory.make(site, gather_options(), {}, counts, GuideField(scene));
  EXPECT_LE(counts.gather, 1u << 13);
  const std::uint64_t made_with = counts.gather;
  factory.shape(record, rule, gather_options(), counts);
  EXPECT_EQ(record.harmonics_reason, HarmonicsReason::kNarrow);
  EXPECT_EQ(counts.gather, made_with);
  EXPECT_GT(record.variance(), 0.0);
  EXPECT_EQ(record.estimate.luminance.value, record.harmonics->luminance.value);
  // More rays are those of new harmonics.
  factory.add_rays(record, gather_options(), 13, false, counts, GuideField(scene));
  EXPECT_EQ(counts.gather, made_with);
  factory.shape(record, rule, gather_options(), counts);
  EXPECT_GT(counts.gather, made_with);
}

TEST(HarmonicsOrder, FollowsTheLobes) {
  const auto order_of = [](Lobe lobe) {
    return harmonics_order_for(Bsdf(Material{"m", {LambertLobe{}, std::move(lobe)}, false}));
  };
  EXPECT_EQ(order_of(LambertLobe{}), 8);
  EXPECT_EQ(order_of(PhongLobe{Rgb::Constant(0.2f), 20.0f}), 16);
  EXPECT_EQ(order_of(PhongLobe{Rgb::Constant(0.2f), 1e6f}), 24);
}

}  // namespace
}  // namespace vrc
