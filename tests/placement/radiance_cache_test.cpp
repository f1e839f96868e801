// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/radiance_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support.h"

namespace vrc {
namespace {

Vec3 random_vector(test::SeededBits& bits) {
  return 2.0 * Vec3(bits.uniform(), bits.uniform(), bits.uniform()) - Vec3::Ones();
}

RadianceRecord random_record(test::SeededBits& bits) {
  RadianceRecord record;
  const Vec3 n = random_vector(bits).normalized();
  record.site.point.normal = n;
  record.site.frame = Frame::around(n);
  ValidRegion& r = record.region;
  r.center = random_vector(bits);
  r.normal = n;
  const double angle = 6.0 * bits.uniform();
  r.axis1 = std::cos(angle) * record.site.frame.tangent + std::sin(angle) * record.site.frame.bitangent;
  r.axis2 = n.cross(r.axis1);
  r.radius1 = 0.02 + 0.1 * bits.uniform();
  r.radius2 = r.radius1 * (0.2 + 0.8 * bits.uniform());
  r.normal_radius = r.radius2;
  r.cos_max_deviation = std::cos(0.1);
  r.normals_count = bits.uniform() < 0.8;
  r.cos_widest_deviation = std::cos(0.3);
  for (Jet2& j : record.radiance) {
    j.value = bits.uniform();
    j.gradient = {20.0 * bits.uniform() - 10.0, 20.0 * bits.uniform() - 10.0};
    j.hessian(0, 0) = 200.0 * bits.uniform() - 100.0;
    j.hessian(1, 1) = 200.0 * bits.uniform() - 100.0;
    j.hessian(0, 1) = j.hessian(1, 0) = 200.0 * bits.uniform() - 100.0;
  }
  return record;
}

/// With a surface that bends and derivatives by tilts.
RadianceRecord random_tilting_record(test::SeededBits& bits) {
  RadianceRecord record = random_record(bits);
  const auto number = [&](double size) { return size * (2.0 * bits.uniform() - 1.0); };
  Mat2& s = record.site.point.shape_operator;
  s << number(2.0), number(2.0), 0.0, number(2.0);
  s(1, 0) = s(0, 1);
  record.site.point.position = record.region.center;
  for (TiltJet& t : record.tilt) {
    t.gradient = {number(4.0), number(4.0)};
    t.mixed << number(20.0), number(20.0), number(20.0), number(20.0);
    t.hessian << number(40.0), number(40.0), 0.0, number(40.0);
    t.hessian(1, 0) = t.hessian(0, 1);
  }
  return record;
}

std::vector<RadianceRecord> random_records(std::size_t count) {
  test::SeededBits bits(42);
  std::vector<RadianceRecord> records;
  for (std::size_t i = 0; i < count; ++i) records.push_back(random_record(bits));
  return records;
}

/// Sixteen points and normals around a record, some beyond its limits.
struct Points16 {
  V3x16 x, n;
  std::array<Vec3, kLanes> position, normal;

  Points16(const RadianceRecord& record, test::SeededBits& bits) {
    const ValidRegion& r = record.region;
    for (int i = 0; i < kLanes; ++i) {
      const Vec3 s = 1.2 * random_vector(bits);
      const Vec3 p = r.center + s[0] * r.radius1 * r.axis1 + s[1] * r.radius2 * r.axis2 +
                     0.2 * s[2] * r.normal_radius * r.normal;
      const Vec3 m = (r.normal + 0.08 * random_vector(bits)).normalized();
      for (int c = 0; c < 3; ++c) {
        (c == 0 ? x.x : c == 1 ? x.y : x.z)[i] = static_cast<float>(p[c]);
        (c == 0 ? n.x : c == 1 ? n.y : n.z)[i] = static_cast<float>(m[c]);
      }
      const auto k = static_cast<std::size_t>(i);
      position[k] = Vec3(x.x[i], x.y[i], x.z[i]);
      normal[k] = Vec3(n.x[i], n.y[i], n.z[i]);
    }
  }
};

TEST(Coverage16, AgreesWithTheWeightInDoublePrecision) {
  test::SeededBits bits(7);
  int positive = 0;
  for (const RadianceRecord& record : random_records(200)) {
    const PackedRecord packed = pack(record);
    const Points16 points(record, bits);
    for (const double support : {1.0, 1.4}) {
      const Coverage16 c = coverage(packed, points.x, points.n, splat(-1), static_cast<float>(support));
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double expected = weight(record.region, points.position[i], points.normal[i], support);
        const double kr = record.region.normal.dot(points.normal[i]);
        if (std::abs(kr - record.region.cos_max_deviation) < 1e-6) continue;  // Either side is right.
        EXPECT_NEAR(c.weight[static_cast<int>(i)], expected, 3e-4);
        positive += expected > 0.0;
      }
    }
    const Coverage16 other = coverage(packed, points.x, points.n, splat(0), 1.4f);
    EXPECT_FALSE(any(other.weight > 0.0f)) << "where the record does not apply";
  }
  EXPECT_GT(positive, 1000);
}

TEST(Coverage16, HoldsNormalsUpToTheWidestDeviationWhereAsked) {
  test::SeededBits bits(9);
  int only_widest = 0;
  for (RadianceRecord record : random_records(200)) {
    record.region.cos_max_deviation = std::cos(0.05);
    const PackedRecord packed = pack(record);
    const Points16 points(record, bits);
    const Coverage16 c = coverage(packed, points.x, points.n, splat(-1), 1.4f);
    const Coverage16 wide = coverage(packed, points.x, points.n, splat(-1), 1.4f, Deviation::kWidest);
    const ValidRegion widest = turned_widest(record.region);
    EXPECT_EQ(widest.cos_max_deviation, std::cos(0.3));
    for (int i = 0; i < kLanes; ++i) {
      const auto k = static_cast<std::size_t>(i);
      EXPECT_NEAR(wide.weight[i], weight(widest, points.position[k], points.normal[k], 1.4), 3e-4);
      only_widest += wide.weight[i] > 0.0f && c.weight[i] == 0.0f;
    }
  }
  EXPECT_GT(only_widest, 200);
}

TEST(Extrapolate, IsTheTaylorPolynomialCutOffAtZero) {
  test::SeededBits bits(8);
  int cut_off = 0;
  for (const RadianceRecord& record : random_records(200)) {
    const PackedRecord packed = pack(record);
    const Points16 points(record, bits);
    const Coverage16 c = coverage(packed, points.x, points.n, splat(-1), 1.4f);
    for (int order = 0; order <= 2; ++order) {
      const V3x16 value = extrapolate(packed, c, order);
      for (std::size_t i = 0; i < kLanes; ++i) {
        const Vec3 offset = points.position[i] - record.region.center;
        const Vec2 d(offset.dot(record.site.frame.tangent), offset.dot(record.site.frame.bitangent));
        for (std::size_t channel = 0; channel < 3; ++channel) {
          const double expected = record.radiance[channel].extrapolate(d, order);
          const F16& lanes = channel == 0 ? value.x : channel == 1 ? value.y : value.z;
          EXPECT_NEAR(lanes[static_cast<int>(i)], std::max(expected, 0.0), 1e-4);
          cut_off += expected < 0.0;
        }
      }
    }
  }
  EXPECT_GT(cut_off, 100);
}

TEST(Extrapolate, KnowsWhatTheNormalTiltsBeyondTheShapeOperator) {
  test::SeededBits bits(10);
  double largest = 0.0;
  for (int run = 0; run < 200; ++run) {
    const RadianceRecord record = random_tilting_record(bits);
    const PackedRecord packed = pack(record);
    const Points16 points(record, bits);
    const Coverage16 c = coverage(packed, points.x, points.n, splat(-1), 1.4f);
    // Half as far, and half of theta_max.
    const Coverage16 inside = drawn_in(packed, c, 0.5f);
    const double farthest = 0.5 * std::tan(0.1);
    for (int i = 0; i < kLanes; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const auto check = [&](const Coverage16& at, const Vec3& offset, const Vec3& normal) {
        const Vec2 d(offset.dot(record.site.frame.tangent), offset.dot(record.site.frame.bitangent));
        const Vec2 tau = tilt_beyond_shape(record.site, d, normal);
        largest = std::max(largest, tau.norm());
        for (int order = 1; order <= 2; ++order) {
          const V3x16 value = extrapolate(packed, at, order);
          for (std::size_t channel = 0; channel < 3; ++channel) {
            const TiltJet& tilt = record.tilt[channel];
            const double change = order == 2 ? tilt.change(d, tau) : tilt.gradient.dot(tau);
            const double expected = record.radiance[channel].extrapolate(d, order) + change;
            const F16& lanes = channel == 0 ? value.x : channel == 1 ? value.y : value.z;
            EXPECT_NEAR(lanes[i], std::max(expected, 0.0), 3e-4);
          }
        }
      };
      const Vec3 offset = points.position[k] - record.region.center, n = record.region.normal;
      check(c, offset, points.normal[k]);
      const double distance = std::hypot(static_cast<double>(c.a[i]), static_cast<double>(c.b[i]));
      const Vec3 m = points.normal[k] / points.normal[k].dot(n) - n;
      check(inside, std::min(1.0, 0.5 / distance) * offset, n + std::min(1.0, farthest / m.norm()) * m);
    }
  }
  EXPECT_GT(largest, 0.1);
}

TEST(Extrapolate, TiltsInAnyOneChannel) {
  test::SeededBits bits(12);
  RadianceRecord record = random_tilting_record(bits);
  record.tilt[0] = record.tilt[1] = {};
  EXPECT_TRUE(pack(record).tilts);
  record.tilt[2] = {};
  EXPECT_FALSE(pack(record).tilts);
}

}  // namespace
}  // namespace vrc
