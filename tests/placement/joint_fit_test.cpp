// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/joint_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "placement_support.h"
#include "support.h"

namespace vrc {
namespace {

constexpr double kSpacing = 0.03, kRadius = 0.04;
constexpr int kSide = 14;

/// The square [0, 1]^2 at z = 0, a second one that faces up close below it.
struct Plane {
  Scene scene{describe()};
  SceneCharts charts{scene};

  static SceneDescription describe() {
    SceneDescription description;
    const auto square = [&](const Vec3& offset, const Vec3& edge2) {
      ShapeDescription shape;
      shape.soup.positions = {offset, offset + Vec3::UnitX(), offset + Vec3::UnitX() + edge2, offset + edge2};
      shape.soup.add_face(std::vector<std::uint32_t>{0, 1, 2, 3});
      shape.materials = {0};
      description.shapes.push_back(shape);
    };
    square(Vec3::Zero(), Vec3::UnitY());
    square(Vec3(0, 0, -1e-4), Vec3::UnitY());
    description.materials.push_back({"matte", {LambertLobe{}}, true});
    description.camera.origin = Vec3(0.5, 0.5, 3.0);
    return description;
  }
  /// On the square `shape`; its triangles are (0, 0) (1, 0) (1, 1) and (0, 0) (1, 1) (0, 1).
  [[nodiscard]] SurfacePoint at(double x, double y, std::uint32_t shape = 0) const {
    const bool lower = y <= x;
    const double u = lower ? x - y : x, v = lower ? y : y - x;
    const SurfacePoint p = scene.surface_point(2 * shape + (lower ? 0 : 1), static_cast<float>(u),
                                               static_cast<float>(v), scene.camera().origin);
    EXPECT_LT((p.position.head<2>() - Vec2(x, y)).norm(), 1e-6);
    return p;
  }
};

const Plane& plane() {
  static const Plane instance;
  return instance;
}

/// A quadratic field on the xy plane, one for each channel, bright enough that no limit acts.
Jet2 field(std::size_t channel, double x, double y) {
  const double k = 1.0 + 0.3 * static_cast<double>(channel);
  Jet2 j;
  j.value = 3.0 + k * (0.7 * x - 0.4 * y + 0.5 * (2.0 * x * x + 1.2 * x * y - 3.0 * y * y));
  j.gradient = k * Vec2(0.7 + 2.0 * x + 0.6 * y, -0.4 + 0.6 * x - 3.0 * y);
  j.hessian << 2.0 * k, 0.6 * k, 0.6 * k, -3.0 * k;
  return j;
}

/// Records on a jittered lattice whose gathered jets have the given deviations.
std::vector<RadianceRecord> lattice(double value_deviation, double gradient_deviation,
                                    double hessian_deviation) {
  test::SeededBits bits(11);
  // Uniform noise of unit variance.
  const auto noise = [&](double deviation) { return deviation * std::sqrt(12.0) * (bits.uniform() - 0.5); };
  std::vector<RadianceRecord> records;
  for (int i = 0; i < kSide * kSide; ++i) {
    RadianceRecord record;
    const Vec3 p(kSpacing * (i % kSide + 0.5 * bits.uniform()), kSpacing * (i / kSide + 0.5 * bits.uniform()),
                 0.0);
    record.site.point = plane().at(p.x(), p.y());
    record.site.frame = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    record.site.pixel_length = 0.002;
    record.estimate.hits.nearest = 1e9;
    for (std::size_t c = 0; c < 3; ++c) {
      Jet2& j = record.estimate.radiance[c] = field(c, p.x(), p.y());
      j.value += noise(value_deviation);
      j.gradient += Vec2(noise(gradient_deviation), noise(gradient_deviation));
      j.hessian(0, 0) += noise(hessian_deviation);
      j.hessian(1, 1) += noise(hessian_deviation);
      j.hessian(0, 1) += noise(hessian_deviation);
      j.hessian(1, 0) = j.hessian(0, 1);
    }
    record.estimate.luminance = record.estimate.radiance[1];
    record.estimate.variance.value = value_deviation * value_deviation;
    record.estimate.variance.gradient.setConstant(gradient_deviation * gradient_deviation);
    record.estimate.variance.hessian.setConstant(hessian_deviation * hessian_deviation);
    record.region = {p,       Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(),
                     kRadius, kRadius,       kRadius,       std::cos(0.1)};
    record.radiance = record.estimate.radiance;
    records.push_back(record);
  }
  return records;
}

/// RMS deviation from the field over the region of the records: what a picture would show.
double rms_error(const std::vector<RadianceRecord>& records) {
  double sum = 0.0;
  int count = 0;
  for (const RadianceRecord& record : records) {
    for (int i = 0; i < 9; ++i) {
      const Vec2 d = 0.5 * kRadius * Vec2(i % 3 - 1, i / 3 - 1);
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3& p = record.region.center;
        const double e = record.radiance[c].extrapolate(d) - field(c, p.x() + d[0], p.y() + d[1]).value;
        sum += e * e;
        ++count;
      }
    }
  }
  return std::sqrt(sum / count);
}

RegionRule rule_with(const CacheOptions& options) {
  RegionRule rule;
  rule.options = &options;
  rule.mean_luminance = 3.0;
  return rule;
}

void fit(std::vector<RadianceRecord>& records, const CacheOptions& options) {
  fit_jointly(plane().charts, records, reaches_of(plane().charts, records, kFitSupport), rule_with(options));
}

TEST(JointFit, KnowsHowValuesFollowTheNormals) {
  // Normals that no shape operator tells: the field plus a quadratic of their tilts.
  const CacheOptions options;
  test::SeededBits bits(13);
  std::vector<RadianceRecord> records = lattice(0, 0, 0);
  const auto by_tilt = [](const Vec2& m) {
    return 0.8 * m[0] - 0.5 * m[1] + m[0] * m[0] - 0.7 * m[0] * m[1];
  };
  for (RadianceRecord& record : records) {
    const Vec2 m(0.04 * (bits.uniform() - 0.5), 0.04 * (bits.uniform() - 0.5));
    record.site.point.normal = record.region.normal = Vec3(m[0], m[1], 1.0).normalized();
    record.site.frame.normal = record.region.normal;
    record.site.frame.tangent = Vec3(1.0, 0.0, -m[0]).normalized();
    record.site.frame.bitangent = record.site.frame.normal.cross(record.site.frame.tangent);
    for (std::size_t c = 0; c < 3; ++c) {
      record.estimate.radiance[c].value += by_tilt(m);
      TiltJet& t = record.estimate.tilt[c];
      t.gradient = {0.8 + 2.0 * m[0] - 0.7 * m[1], -0.5 - 0.7 * m[0]};
      t.hessian << 2.0, -0.7, -0.7, 0.0;
    }
  }
  const std::vector<RadianceRecord> before = records;
  const auto deviation = [&](const std::vector<RadianceRecord>& fitted) {
    double sum = 0.0;
    for (std::size_t i = 0; i < fitted.size(); ++i)
      sum += std::pow(fitted[i].radiance[0].value - before[i].estimate.radiance[0].value, 2);
    return std::sqrt(sum / static_cast<double>(fitted.size()));
  };
  for (RadianceRecord& record : records) {  // noisy ones, so that neighbours count
    record.estimate.variance.value = 1e-4;
    record.estimate.variance.gradient.setConstant(1e-2);
    record.estimate.variance.hessian.setConstant(1.0);
  }
  std::vector<RadianceRecord> ignorant = records;
  for (RadianceRecord& record : ignorant) record.estimate.tilt = {};
  fit(records, options);
  fit(ignorant, options);
  EXPECT_LT(deviation(records), 1e-4);
  EXPECT_GT(deviation(ignorant), 10.0 * deviation(records));
}

TEST(JointFit, LeavesNoiselessRecordsOfAQuadraticFieldUnchanged) {
  const CacheOptions options;
  std::vector<RadianceRecord> records = lattice(0, 0, 0);
  const std::vector<RadianceRecord> before = records;
  fit(records, options);
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto expected = test::entries(before[i].radiance[c]),
                 fitted = test::entries(records[i].radiance[c]);
      for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(fitted[k], expected[k], 1e-8) << "entry " << k;
    }
    EXPECT_EQ(records[i].region.radius1, before[i].region.radius1);
    EXPECT_EQ(test::entries(records[i].estimate.luminance), test::entries(before[i].estimate.luminance));
  }
}

TEST(JointFit, LowersTheErrorOfNoisyRecords) {
  const CacheOptions options;
  struct Noise {
    double value, gradient, hessian, least_gain;
  };
  for (const Noise& n :
       {Noise{0.1, 0.5, 5.0, 1.5}, Noise{0.01, 3.0, 100.0, 2.0}, Noise{0.1, 5.0, 300.0, 1.5}}) {
    std::vector<RadianceRecord> records = lattice(n.value, n.gradient, n.hessian);
    const double before = rms_error(records);
    fit(records, options);
    EXPECT_LT(rms_error(records), before / n.least_gain) << n.value << ' ' << n.gradient << ' ' << n.hessian;
  }
}

TEST(JointFit, TakesNothingFromOtherSurfaces) {
  const CacheOptions options;
  std::vector<RadianceRecord> records = lattice(0.1, 1.0, 20.0);
  std::vector<RadianceRecord> with_strangers = records;
  for (RadianceRecord stranger : records) {
    for (Jet2& j : stranger.estimate.radiance) j.value += 100.0;
    const SurfacePoint own = stranger.site.point;
    stranger.site.point = plane().at(own.position.x(), own.position.y(), 1);
    with_strangers.push_back(stranger);
    stranger.site.point = own;
    stranger.region.normal = Vec3(1, 0, 1).normalized();
    with_strangers.push_back(stranger);
  }
  const std::size_t own = records.size();
  fit(records, options);
  fit(with_strangers, options);
  for (std::size_t i = 0; i < own; ++i) {
    EXPECT_EQ(test::entries(records[i].radiance[0]), test::entries(with_strangers[i].radiance[0]));
  }
}

TEST(JointFit, IsTheSameAtAnyThreadCount) {
  const CacheOptions options;
  std::vector<RadianceRecord> one = lattice(0.1, 1.0, 20.0), two = one;
  set_thread_count(1);
  fit(one, options);
  set_thread_count(2);
  fit(two, options);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(test::entries(one[i].radiance[2]), test::entries(two[i].radiance[2]));
  }
}

}  // namespace
}  // namespace vrc
