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
  for (Jet2& j : record.radiance) {
    j.value = bits.uniform();
    j.gradient = {20.0 * bits.uniform() - 10.0, 20.0 * bits.uniform() - 10.0};
    j.hessian(0, 0) = 200.0 * bits.uniform() - 100.0;
    j.hessian(1, 1) = 200.0 * bits.uniform() - 100.0;
    j.hessian(0, 1) = j.hessian(1, 0) = 200.0 * bits.uniform() - 100.0;
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

}  // namespace
}  // namespace vrc
