// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/record_maker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "placement_support.h"
#include "support.h"

namespace vrc {
namespace {

constexpr double kMean = 0.4;

/// A record on the xy plane whose nearest hit is far.
RadianceRecord flat_record(double radius1, double radius2) {
  RadianceRecord record;
  record.site.frame = Frame::around(Vec3::UnitZ());
  record.site.point.normal = Vec3::UnitZ();
  record.estimate.hits.nearest = std::numeric_limits<double>::infinity();
  ValidRegion& r = record.region;
  r.center = Vec3::Zero();
  r.normal = Vec3::UnitZ();
  r.axis1 = Vec3(std::cos(0.5), std::sin(0.5), 0);
  r.axis2 = Vec3(-std::sin(0.5), std::cos(0.5), 0);
  r.radius1 = radius1;
  r.radius2 = radius2;
  r.normal_radius = radius2;
  return record;
}

std::array<Jet2, 3> random_jets(test::SeededBits& bits, double size) {
  std::array<Jet2, 3> jets;
  for (Jet2& j : jets) {
    const auto number = [&] { return size * (2.0 * bits.uniform() - 1.0); };
    j.value = bits.uniform();
    j.gradient = {number(), number()};
    j.hessian << number(), number(), 0.0, number();
    j.hessian(1, 0) = j.hessian(0, 1);
  }
  return jets;
}

TEST(SetRadiance, KeepsBothOrdersWithinThePerceivedRadianceOverTheRegion) {
  test::SeededBits bits(3);
  int limited = 0;
  for (int run = 0; run < 200; ++run) {
    RadianceRecord record = flat_record(0.2, 0.05);
    const std::array<Jet2, 3> jets = random_jets(bits, std::pow(10.0, 4.0 * bits.uniform()));
    set_radiance(record, jets, kMean);
    limited += record.clamp_factor < 1.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Jet2& j = record.radiance[c];
      EXPECT_EQ(j.value, jets[c].value);
      const double bound = std::sqrt(j.value * j.value + 0.04 * kMean * kMean) * (1.0 + 1e-9);
      for (int i = 0; i < 32; ++i) {
        const double phi = 2.0 * kPi * i / 32.0;
        const Vec3 p = 0.2 * std::cos(phi) * record.region.axis1 + 0.05 * std::sin(phi) * record.region.axis2;
        const Vec2 d(p.dot(record.site.frame.tangent), p.dot(record.site.frame.bitangent));
        EXPECT_LE(std::abs(j.gradient.dot(d)), bound);
        EXPECT_LE(std::abs(0.5 * d.dot(j.hessian * d)), bound);
      }
      EXPECT_GE(j.gradient.dot(jets[c].gradient), 0.0);
      EXPECT_NEAR(j.gradient[0] * jets[c].gradient[1], j.gradient[1] * jets[c].gradient[0],
                  1e-9 * jets[c].gradient.squaredNorm());
    }
  }
  EXPECT_GT(limited, 50);
  EXPECT_LT(limited, 200);
}

TEST(SetRadiance, LeavesModestDerivativesAlone) {
  test::SeededBits bits(4);
  RadianceRecord record = flat_record(0.02, 0.01);
  const std::array<Jet2, 3> jets = random_jets(bits, 1.0);
  set_radiance(record, jets, kMean);
  EXPECT_EQ(record.clamp_factor, 1.0);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(test::entries(record.radiance[c]), test::entries(jets[c]));
}

TEST(SetRadiance, LimitsTiltsAsItLimitsTheDerivativesOfTheSameOrder) {
  test::SeededBits bits(6);
  for (int run = 0; run < 50; ++run) {
    RadianceRecord record = flat_record(0.2, 0.05);
    const std::array<Jet2, 3> jets = random_jets(bits, 1e3);
    for (TiltJet& t : record.estimate.tilt) {
      t.gradient = {1.0, -2.0};
      t.mixed << 3.0, 4.0, 5.0, 6.0;
      t.hessian << 7.0, 8.0, 8.0, 9.0;
    }
    set_radiance(record, jets, kMean);
    for (std::size_t c = 0; c < 3; ++c) {
      const TiltJet &gathered = record.estimate.tilt[c], &tilt = record.tilt[c];
      const double first = record.radiance[c].gradient.norm() / jets[c].gradient.norm();
      const double second = record.radiance[c].hessian.norm() / jets[c].hessian.norm();
      EXPECT_LT((tilt.gradient - first * gathered.gradient).norm(), 1e-12);
      EXPECT_LT((tilt.mixed - second * gathered.mixed).norm(), 1e-12);
      EXPECT_LT((tilt.hessian - second * gathered.hessian).norm(), 1e-12);
    }
  }
}

TEST(NormalDeviation, FollowsTheLobeAndTheThreshold) {
  EXPECT_NEAR(normal_deviation_for(1.5e-4, 100.0), 0.1, 1e-3);
  EXPECT_NEAR(normal_deviation_for(1.5e-4, 1600.0), 0.05, 5e-4);
  EXPECT_NEAR(normal_deviation_for(1.5e-4 / 256.0, 100.0), 0.05, 5e-4);
  EXPECT_EQ(normal_deviation_for(1.5e-4, 0.0), kLargestNormalDeviation);
  EXPECT_EQ(normal_deviation_for(1e-2, 5.0), kLargestNormalDeviation);

  CacheOptions options;
  RegionRule rule;
  rule.options = &options;
  RadianceRecord record = flat_record(1, 1);
  record.site.pixel_length = 0.01;
  shape_record(record, rule, 400.0);
  EXPECT_EQ(record.region.cos_max_deviation, std::cos(normal_deviation_for(rule.epsilon, 400.0)));
  EXPECT_LT(record.region.cos_widest_deviation, std::cos(kLargestNormalDeviation));
  options.max_normal_deviation = 0.2;
  shape_record(record, rule, 400.0);
  EXPECT_EQ(record.region.cos_max_deviation, std::cos(0.2));
  EXPECT_EQ(turned_widest(record.region).cos_max_deviation, std::cos(0.2));
}

TEST(Perceived, StaysAwayFromZeroInTheDark) {
  EXPECT_NEAR(perceived(0.0, 0.5), 0.1, 1e-12);
  EXPECT_NEAR(perceived(100.0, 0.5), 100.0, 1e-3);
}

TEST(ShapeRecord, KeepsTheRadiiBetweenOnePixelAndATenthOfThePicture) {
  CacheOptions options;
  RegionRule rule;
  rule.options = &options;
  rule.mean_luminance = kMean;
  rule.picture_width = 200;
  test::SeededBits bits(5);
  for (int run = 0; run < 300; ++run) {
    RadianceRecord record = flat_record(1, 1);
    record.site.pixel_length = 0.01;
    record.estimate.luminance = random_jets(bits, std::pow(10.0, 8.0 * bits.uniform() - 3.0))[0];
    record.estimate.radiance.fill(record.estimate.luminance);
    if (run % 2 == 0) {
      record.estimate.hits.nearest = std::pow(10.0, -4.0 * bits.uniform());
      record.estimate.hits.nearest_normal =
          Vec3(bits.uniform() - 0.5, bits.uniform() - 0.5, 0.2).normalized();
    }
    shape_record(record, rule, 0.0);
    const ValidRegion& r = record.region;
    for (const double radius : {r.radius1, r.radius2}) {
      EXPECT_GE(radius, 0.01);
      EXPECT_LE(radius, 0.2 * (1.0 + 1e-12));
    }
    // Across the wall the region ends at the nearest hit, or at the smallest radius.
    EXPECT_LE(std::min(r.radius1, r.radius2), std::max(0.01, record.estimate.hits.nearest));
    EXPECT_NEAR(r.axis1.norm(), 1.0, 1e-9);
    EXPECT_NEAR(r.axis1.dot(r.axis2), 0.0, 1e-9);
    EXPECT_NEAR(r.axis1.dot(r.normal), 0.0, 1e-9);
    EXPECT_GE(r.normal_radius, std::min(r.radius1, r.radius2));
  }
}

TEST(ShapeRecord, TellsWhatRegionsLargerThanTheAccuracyAllowsMiss) {
  CacheOptions options;
  options.error = 0.02;
  RegionRule rule;
  rule.options = &options;
  rule.mean_luminance = kMean;
  const auto misfit_with = [&](double bend) {
    RadianceRecord record = flat_record(1, 1);
    record.site.pixel_length = 0.01;
    record.estimate.luminance.value = 0.5;
    record.estimate.luminance.hessian = bend * Mat2::Identity();
    record.estimate.radiance.fill(record.estimate.luminance);
    shape_record(record, rule, 0.0);
    return record.misfit;
  };
  // Radii fall as the fourth root of the Hessian, below a pixel from this one on.
  const double picture = 0.01 * rule.picture_width, pixel = 0.01;
  const double least =
      4.0 * rule.epsilon * picture * picture * perceived(0.5, kMean) / (kPi * std::pow(pixel, 4.0));
  EXPECT_EQ(misfit_with(0.9 * least), 0.0);
  const double little = misfit_with(2.0 * least), more = misfit_with(3.0 * least);
  EXPECT_GT(little, 8.0 * options.error * options.error * 0.25);
  EXPECT_NEAR(more / little, 2.0, 1e-6);  // radius^-4 - 1
  EXPECT_EQ(misfit_with(1e6 * least), 0.25) << "not more than the light itself";
  options.metric = PlacementMetric::kUniform;
  EXPECT_EQ(misfit_with(3.0 * least), 0.0);
}

}  // namespace
}  // namespace vrc
