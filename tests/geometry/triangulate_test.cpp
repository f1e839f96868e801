// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/triangulate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support.h"

namespace vrc {
namespace {

Vec3 twice_vector_area(const std::vector<Vec3>& p, const Triangle& t) {
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
}

// Planar and simple: the areas add up, nothing is reversed or flat, and every corner is used.
void expect_proper_triangulation(const std::vector<Vec3>& polygon) {
  const std::vector<Triangle> triangles = triangulate_polygon(polygon);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  const Vec3 whole = newell_normal(polygon);
  double sum = 0.0;
  std::set<std::uint32_t> used;
  for (const Triangle& t : triangles) {
    const double area = twice_vector_area(polygon, t).dot(whole.normalized());
    EXPECT_GT(area, 1e-11 * whole.norm()) << t[0] << ' ' << t[1] << ' ' << t[2];
    sum += area;
    used.insert(t.begin(), t.end());
  }
  EXPECT_NEAR(sum, whole.norm(), 1e-8 * whole.norm());
  EXPECT_EQ(used.size(), polygon.size());
}

// In every rotation, in both directions and in tilted planes.
void expect_proper_everywhere(std::vector<Vec3> polygon) {
  const Mat3 tilt = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (int direction = 0; direction < 2; ++direction) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      expect_proper_triangulation(polygon);
      std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    }
    std::reverse(polygon.begin(), polygon.end());
  }
  for (Vec3& p : polygon) p = tilt * p;
  expect_proper_triangulation(polygon);
}

std::vector<Vec3> spiral(int turns_in_steps) {
  std::vector<Vec3> outer;
  std::vector<Vec3> inner;
  for (int i = 0; i <= turns_in_steps; ++i) {
    const double angle = 0.35 * i;
    const Vec3 direction(std::cos(angle), std::sin(angle), 0.0);
    outer.push_back((1.0 + 0.3 * angle) * direction);
    inner.push_back((0.2 + 0.3 * angle) * direction);
  }
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  return outer;
}

TEST(Triangulate, TriangleStaysAsItIs) {
  const std::vector<Vec3> triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THAT(triangulate_polygon(triangle), testing::ElementsAre(Triangle{0, 1, 2}));
}

TEST(Triangulate, ConvexQuadIsCutAlongItsShorterDiagonal) {
  const std::vector<Vec3> quad{{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {1, 1, 0}};
  EXPECT_THAT(triangulate_polygon(quad), testing::ElementsAre(Triangle{1, 2, 3}, Triangle{1, 3, 0}));
}

TEST(Triangulate, ConvexPolygonBecomesAFan) {
  std::vector<Vec3> polygon;
  for (int i = 0; i < 9; ++i) polygon.emplace_back(std::cos(0.69 * i), std::sin(0.69 * i), 2.0);
  for (const Triangle& t : triangulate_polygon(polygon)) EXPECT_EQ(t[0], 0u);
  expect_proper_everywhere(polygon);
}

TEST(Triangulate, ArrowQuad) { expect_proper_everywhere({{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}}); }

TEST(Triangulate, ConcaveL) {
  expect_proper_everywhere({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}});
}

TEST(Triangulate, Comb) {
  std::vector<Vec3> comb{{0, -1, 0}};
  for (int i = 0; i < 8; ++i) {
    comb.emplace_back(i + 0.6, i == 0 ? -1 : 0, 0);
    comb.emplace_back(i + 0.7, 5, 0);
    comb.emplace_back(i + 0.9, 5, 0);
  }
  comb.emplace_back(9, 0, 0);
  comb.emplace_back(9, 6, 0);
  comb.emplace_back(0, 6, 0);
  expect_proper_everywhere(comb);
}

TEST(Triangulate, Spiral) {
  expect_proper_everywhere(spiral(12));
  expect_proper_triangulation(spiral(50));
}

TEST(Triangulate, CollinearCornersBecomeCornersOfProperTriangles) {
  expect_proper_everywhere({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 2, 0}});
  expect_proper_everywhere(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
  // Not exactly collinear in floating point.
  expect_proper_everywhere({{0.1, 0.1, 0}, {0.2, 0.2, 0}, {0.3, 0.3, 0}, {0.7, 0.7, 0}, {0.1, 0.9, 0}});
}

TEST(Triangulate, CollinearUpToSinglePrecision) {
  test::SeededBits random(1);
  for (int round = 0; round < 50; ++round) {
    std::vector<Vec3> polygon{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 2, 0}};
    const Mat3 turn =
        Eigen::AngleAxisd(6.0 * random.uniform(), Vec3(1, -2, 3).normalized()).toRotationMatrix();
    for (Vec3& p : polygon) p = (turn * p).cast<float>().cast<double>();
    for (const Triangle& t : triangulate_polygon(polygon)) {
      EXPECT_GT(twice_vector_area(polygon, t).norm(), 0.5);
    }
  }
}

TEST(Triangulate, FeaturesBelowSinglePrecision) {
  expect_proper_everywhere(
      {{0, 0, 0}, {1, 0, 0}, {1, 1e-9, 0}, {0.5, 5e-10, 0}, {0.5, 2e-9, 0}, {1, 3e-9, 0}, {0, 3e-9, 0}});
}

TEST(Triangulate, BridgeToAHole) {
  // The outer square and the hole are joined by an edge that is walked twice.
  const std::vector<Vec3> ring{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                               {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  expect_proper_triangulation(ring);
}

TEST(Triangulate, RandomStarPolygons) {
  test::SeededBits random(7);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec3> star;
    const std::size_t n = 4 + random.below(40);
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(n);
      star.push_back((0.05 + random.uniform()) * Vec3(std::cos(angle), std::sin(angle), 0.0));
    }
    expect_proper_triangulation(star);
  }
}

TEST(Triangulate, SelfIntersectionKeepsTheSignedArea) {
  const std::vector<Vec3> polygon{{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {1, -1, 0}, {0, 2, 0}};
  const std::vector<Triangle> triangles = triangulate_polygon(polygon);
  ASSERT_EQ(triangles.size(), 3u);
  Vec3 sum = Vec3::Zero();
  for (const Triangle& t : triangles) sum += twice_vector_area(polygon, t);
  EXPECT_LT((sum - newell_normal(polygon)).norm(), 1e-12);
}

TEST(Triangulate, NothingWithoutArea) {
  EXPECT_TRUE(triangulate_polygon(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}}).empty());
  EXPECT_TRUE(triangulate_polygon(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}).empty());
  EXPECT_TRUE(triangulate_polygon(std::vector<Vec3>(5, Vec3(1, 2, 3))).empty());
}

TEST(NewellNormal, IsTwiceTheArea) {
  const std::vector<Vec3> square{{5, 5, 1}, {7, 5, 1}, {7, 7, 1}, {5, 7, 1}};
  EXPECT_EQ(newell_normal(square), Vec3(0, 0, 8));
}

}  // namespace
}  // namespace vrc
