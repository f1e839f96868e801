// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/polygon_soup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/error.h"

namespace vrc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A quad and a triangle over a common edge, with all optional arrays.
PolygonSoup two_faces() {
  PolygonSoup soup;
  soup.source = "two_faces";
  soup.positions = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(0, 1, 0), Vec3(3, 0.5, 0)};
  soup.normals = {Vec3::UnitZ()};
  soup.uvs = {Vec2(0, 0), Vec2(1, 1)};
  soup.add_face(std::array{0u, 1u, 2u, 3u});
  soup.add_face(std::array{1u, 4u, 2u});
  soup.corner_normal.assign(7, 0);
  soup.corner_uv = {0, 1, 0, 1, 0, 1, 0};
  soup.face_material = {0, 3};
  return soup;
}

Vec3 area_vector(const PolygonSoup& soup, std::size_t face) {
  const auto corners = soup.face_positions(face);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 first = soup.positions[corners[0]];
    sum += 0.5 * (soup.positions[corners[i]] - first).cross(soup.positions[corners[i + 1]] - first);
  }
  return sum;
}

TEST(PolygonSoup, AddFaceKeepsCornersOfEveryFace) {
  PolygonSoup soup;
  EXPECT_EQ(soup.face_count(), 0u);
  soup.positions.assign(5, Vec3::Zero());
  soup.add_face(std::array{0u, 1u, 2u, 3u});
  soup.add_face(std::array{2u, 3u, 4u});
  EXPECT_EQ(soup.face_count(), 2u);
  EXPECT_THAT(soup.face_positions(0), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(soup.face_positions(1), ElementsAre(2, 3, 4));
  EXPECT_THAT(soup.corner_normal, IsEmpty());
  EXPECT_THAT(soup.corner_uv, IsEmpty());
  EXPECT_THAT(soup.face_material, IsEmpty());
}

TEST(PolygonSoup, AddFaceKeepsOptionalArraysInStep) {
  PolygonSoup soup = two_faces();
  soup.add_face(std::array{0u, 1u, 4u});
  soup.validate();
  EXPECT_THAT(soup.corner_normal,
              ElementsAre(0, 0, 0, 0, 0, 0, 0, kInvalidIndex, kInvalidIndex, kInvalidIndex));
  EXPECT_EQ(soup.corner_uv.back(), kInvalidIndex);
  EXPECT_THAT(soup.face_material, ElementsAre(0, 3, 0));
}

TEST(PolygonSoup, BoundsCoverUsedPositionsOnly) {
  PolygonSoup soup = two_faces();
  soup.positions.emplace_back(100, 100, 100);
  EXPECT_EQ(soup.bounds().min(), Vec3(0, 0, 0));
  EXPECT_EQ(soup.bounds().max(), Vec3(3, 1, 0));
  EXPECT_TRUE(PolygonSoup().bounds().isEmpty());
}

TEST(PolygonSoup, ValidateAcceptsWholeAndEmptySoups) {
  EXPECT_NO_THROW(two_faces().validate());
  EXPECT_NO_THROW(PolygonSoup().validate());
}

TEST(PolygonSoup, ValidateNamesEveryBrokenInvariant) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* message;
    std::function<void(PolygonSoup&)> damage;
  };
  const std::vector<Case> cases{
      {"position 1 is not finite", [](PolygonSoup& s) { s.positions[1][2] = kNan; }},
      {"position 0 is not finite or above 1e18", [](PolygonSoup& s) { s.positions[0][0] = -2e18; }},
      {"normal 0 is not a unit vector", [](PolygonSoup& s) { s.normals[0] *= 1.1; }},
      {"normal 0 is not a unit vector", [](PolygonSoup& s) { s.normals[0][1] = kNan; }},
      {"texture coordinate 1 is not finite", [](PolygonSoup& s) { s.uvs[1][0] = kNan; }},
      {"refers to position 5, but there are 5", [](PolygonSoup& s) { s.corner_position[6] = 5; }},
      {"refers to position", [](PolygonSoup& s) { s.corner_position[0] = kInvalidIndex; }},
      {"corner 2 refers to normal 1", [](PolygonSoup& s) { s.corner_normal[2] = 1; }},
      {"corner 3 refers to texture coordinate 2", [](PolygonSoup& s) { s.corner_uv[3] = 2; }},
      {"number of corner normals", [](PolygonSoup& s) { s.corner_normal.pop_back(); }},
      {"number of corner texture coordinates", [](PolygonSoup& s) { s.corner_uv.push_back(0); }},
      {"number of face materials", [](PolygonSoup& s) { s.face_material.pop_back(); }},
      {"face 1 has fewer than three corners", [](PolygonSoup& s) { s.face_begin[1] = 5; }},
      {"face 1 has fewer than three corners", [](PolygonSoup& s) { s.face_begin[1] = 9; }},
      {"does not begin at corner 0", [](PolygonSoup& s) { s.face_begin[0] = 1; }},
      {"do not cover all corners", [](PolygonSoup& s) { s.corner_position.push_back(0); }},
      {"do not cover all corners", [](PolygonSoup& s) { s.face_begin.clear(); }},
  };
  for (const Case& c : cases) {
    PolygonSoup soup = two_faces();
    c.damage(soup);
    try {
      soup.validate();
      ADD_FAILURE() << "accepted: " << c.message;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.message));
      EXPECT_THAT(error.what(), HasSubstr("two_faces: "));
    }
  }
}

TEST(PolygonSoupTransform, MovesPositionsAndKeepsNormalsPerpendicular) {
  PolygonSoup soup = two_faces();
  Mat4 shear = Mat4::Identity();
  shear(2, 0) = 1.5;  // z += 1.5 x tilts the plane z = 0.
  shear(1, 1) = 3.0;
  shear.topRightCorner<3, 1>() = Vec3(10, 20, 30);
  transform(soup, shear);
  EXPECT_TRUE(soup.positions[2].isApprox(Vec3(12, 23, 33)));
  soup.validate();
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    EXPECT_NEAR(area_vector(soup, face).normalized().dot(soup.normals[0]), 1.0, 1e-12);
  }
}

TEST(PolygonSoupTransform, MirrorKeepsTheOutside) {
  for (const double scale : {1.0, 1e-120, 1e15}) {
    PolygonSoup soup = two_faces();
    const Mat4 mirror = Eigen::Vector4d(-scale, scale, scale, 1).asDiagonal();
    transform(soup, mirror);
    EXPECT_THAT(soup.face_positions(0), ElementsAre(0, 3, 2, 1));
    EXPECT_THAT(soup.face_positions(1), ElementsAre(1, 2, 4));
    EXPECT_THAT(soup.corner_uv, ElementsAre(0, 1, 0, 1, 0, 0, 1));
    EXPECT_EQ(soup.normals[0], Vec3::UnitZ());
    soup.validate();
  }
}

TEST(PolygonSoupTransform, MirrorThroughTheSurfaceTurnsItsNormal) {
  PolygonSoup soup = two_faces();
  transform(soup, Eigen::Vector4d(1, 1, -1, 1).asDiagonal());
  EXPECT_EQ(soup.normals[0], -Vec3::UnitZ());
  EXPECT_LT(area_vector(soup, 0)[2], 0.0);
}

TEST(PolygonSoupTransform, RefusesWhatIsNoPlacementAndLeavesTheSoup) {
  Mat4 projective = Mat4::Identity();
  projective(3, 2) = 0.1;
  Mat4 broken = Mat4::Identity();
  broken(0, 3) = std::numeric_limits<double>::infinity();
  const Mat4 flat = Eigen::Vector4d(1, 0, 1, 1).asDiagonal();
  const Mat4 zero = Eigen::Vector4d(0, 0, 0, 1).asDiagonal();
  const Mat4 huge = Eigen::Vector4d(1e18, 1, 1, 1).asDiagonal();
  for (const Mat4& matrix : {projective, broken, flat, zero, huge}) {
    PolygonSoup soup = two_faces();
    EXPECT_THROW(transform(soup, matrix), InputError);
    EXPECT_EQ(soup.positions, two_faces().positions);
    EXPECT_EQ(soup.normals, two_faces().normals);
  }
}

}  // namespace
}  // namespace vrc
