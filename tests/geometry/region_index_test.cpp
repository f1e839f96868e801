// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/region_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sample_meshes.h"
#include "support.h"

namespace vrc {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

bool holds(const PatchFootprint& f, const Vec2& uv) {
  return (f.low.array() <= uv.array()).all() && (uv.array() <= f.high.array()).all();
}

std::vector<std::uint32_t> found(const RegionIndex& index, std::uint32_t patch, const Vec2& uv) {
  const auto candidates = index.candidates(patch, uv);
  return {candidates.begin(), candidates.end()};
}

// Boxes of sizes from 1 to 1000, dense in one corner of patch 1; patch 2 is empty.
std::vector<PatchFootprint> random_footprints(std::size_t count) {
  test::SeededBits random(6);
  std::vector<PatchFootprint> footprints;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t patch = i % 2 == 0 ? 0 : i % 3 == 0 ? 3 : 1;
    const double crowd = patch == 1 ? 3.0 : 1.0;
    const Vec2 center(10.0 * std::pow(random.uniform(), crowd), 3.0 * std::pow(random.uniform(), crowd));
    const double size = 0.002 * std::pow(1000.0, std::pow(random.uniform(), 2.0));
    const Vec2 half(size * (0.2 + random.uniform()), size * (0.2 + random.uniform()));
    footprints.push_back({i, patch, center - half, center + half});
  }
  return footprints;
}

// Turned ellipses of ratios up to 20 that fill their boxes, in place of some footprints.
std::vector<PatchFootprint> random_ellipses(std::size_t count) {
  test::SeededBits random(8);
  std::vector<PatchFootprint> footprints = random_footprints(count);
  for (PatchFootprint& f : footprints) {
    if (f.record % 4 == 0) continue;
    f.center = 0.5 * (f.low + f.high);
    const Vec2 radii((f.high - f.low).norm(), (f.high - f.low).norm() * (0.05 + 0.95 * random.uniform()));
    const Mat2 axes = Eigen::Rotation2Dd(kPi * random.uniform()).toRotationMatrix();
    f.shape = radii.cwiseInverse().asDiagonal() * axes.transpose();
    const Vec2 half = (axes * radii.asDiagonal()).rowwise().norm();
    f.low = f.center - half;
    f.high = f.center + half;
  }
  return footprints;
}

bool covers(const PatchFootprint& f, const Vec2& uv, double radius = 1.0) {
  return holds(f, uv) && (f.shape * (uv - f.center)).norm() <= radius;
}

void expect_all_found(const RegionIndex& index, const std::vector<PatchFootprint>& footprints,
                      std::uint32_t patch, const Vec2& uv) {
  const std::vector<std::uint32_t> candidates = found(index, patch, uv);
  EXPECT_TRUE(std::is_sorted(candidates.begin(), candidates.end()));
  EXPECT_EQ(std::adjacent_find(candidates.begin(), candidates.end()), candidates.end());
  for (const PatchFootprint& f : footprints) {
    if (f.patch != patch || !holds(f, uv)) continue;
    EXPECT_TRUE(std::binary_search(candidates.begin(), candidates.end(), f.record)) << f.record;
  }
}

TEST(RegionIndex, FindsWhatBruteForceFinds) {
  const std::vector<PatchFootprint> footprints = random_footprints(3000);
  const RegionIndex index(4, footprints);
  test::SeededBits random(9);
  for (int i = 0; i < 3000; ++i) {
    const Vec2 uv(12.0 * random.uniform() - 1.0, 4.0 * random.uniform() - 0.5);
    expect_all_found(index, footprints, static_cast<std::uint32_t>(i % 4), uv);
  }
}

TEST(RegionIndex, FindsTheBordersOfBoxes) {
  const std::vector<PatchFootprint> footprints = random_footprints(1500);
  const RegionIndex index(4, footprints);
  for (const PatchFootprint& f : footprints) {
    for (const double x : {f.low.x(), f.high.x()}) {
      for (const double y : {f.low.y(), f.high.y()}) expect_all_found(index, footprints, f.patch, Vec2(x, y));
    }
  }
}

TEST(RegionIndex, CoveringIsWhatBruteForceFindsInEllipses) {
  const std::vector<PatchFootprint> footprints = random_ellipses(3000);
  const RegionIndex index(4, footprints);
  test::SeededBits random(5);
  std::size_t all = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto patch = static_cast<std::uint32_t>(i % 4);
    const Vec2 uv(12.0 * random.uniform() - 1.0, 4.0 * random.uniform() - 0.5);
    std::vector<std::uint32_t> records{77777};
    index.covering({patch, uv}, records);
    ASSERT_EQ(records.front(), 77777u);
    records.erase(records.begin());
    EXPECT_TRUE(std::is_sorted(records.begin(), records.end()));
    for (const PatchFootprint& f : footprints) {
      if (f.patch != patch) continue;
      const bool returned = std::binary_search(records.begin(), records.end(), f.record);
      if (covers(f, uv)) {
        EXPECT_TRUE(returned) << f.record;
        ++all;
      } else if (f.record % 4 != 0 && !covers(f, uv, 1.001)) {
        EXPECT_FALSE(returned) << f.record;
      }
    }
  }
  EXPECT_GT(all, 5000u);
}

TEST(RegionIndex, BatchesAnswerAsSinglePointsDo) {
  const std::vector<PatchFootprint> footprints = random_ellipses(2000);
  const RegionIndex index(4, footprints);
  test::SeededBits random(12);
  RecordsOfPoints batch;
  for (const std::size_t size : {0, 1, 15, 16, 17, 100}) {
    std::vector<PatchPoint> points;
    for (std::size_t i = 0; i < size; ++i) {
      const Vec2 uv(12.0 * random.uniform() - 1.0, 4.0 * random.uniform() - 0.5);
      points.push_back({static_cast<std::uint32_t>(i % 4), uv});
    }
    index.covering(points, batch);
    ASSERT_EQ(batch.begin.size(), size + 1);
    EXPECT_EQ(batch.begin.back(), batch.records.size());
    for (std::size_t i = 0; i < size; ++i) {
      std::vector<std::uint32_t> records;
      index.covering(points[i], records);
      EXPECT_EQ(records, std::vector<std::uint32_t>(batch[i].begin(), batch[i].end()));
    }
  }
}

TEST(RegionIndex, EllipsesOfEverySizeAndShapeHoldTheirPoints) {
  test::SeededBits random(14);
  std::vector<PatchFootprint> footprints{{0, 0, Vec2(-1, -1), Vec2(1, 1)}};
  for (std::uint32_t i = 1; i < 400; ++i) {
    const double size = std::pow(10.0, -7.0 * random.uniform());
    const Vec2 radii(size, size * std::pow(10.0, -4.0 * random.uniform()));
    const Mat2 axes = Eigen::Rotation2Dd(kPi * random.uniform()).toRotationMatrix();
    const Vec2 center(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
    const Vec2 half = (axes * radii.asDiagonal()).rowwise().norm();
    footprints.push_back(
        {i, 0, center - half, center + half, center, radii.cwiseInverse().asDiagonal() * axes.transpose()});
  }
  const RegionIndex index(1, footprints);
  for (const PatchFootprint& f : footprints) {
    if (f.record == 0) continue;
    for (int i = 0; i < 16; ++i) {
      const double angle = kPi * i / 8.0;
      const Vec2 uv = f.center + (1.0 - 1e-9) * f.shape.inverse() * Vec2(std::cos(angle), std::sin(angle));
      std::vector<std::uint32_t> records;
      index.covering({0, uv}, records);
      EXPECT_TRUE(std::binary_search(records.begin(), records.end(), f.record)) << f.record;
    }
  }
}

std::vector<std::uint32_t> meeting(const std::vector<PatchFootprint>& footprints, std::uint32_t patch,
                                   const Vec2& low, const Vec2& high) {
  std::vector<std::uint32_t> records;
  for (const PatchFootprint& f : footprints) {
    if (f.patch == patch && (f.low.array() <= high.array()).all() && (low.array() <= f.high.array()).all())
      records.push_back(f.record);
  }
  return records;
}

TEST(RegionIndex, FindsInABoxWhatBruteForceFinds) {
  const std::vector<PatchFootprint> footprints = random_footprints(3000);
  const RegionIndex index(4, footprints);
  test::SeededBits random(4);
  std::vector<std::uint32_t> records;
  std::size_t extra = 0;
  std::size_t all = 0;
  for (int i = 0; i < 600; ++i) {
    const auto patch = static_cast<std::uint32_t>(i % 4);
    const Vec2 low(12.0 * random.uniform() - 1.0, 4.0 * random.uniform() - 0.5);
    const double size = i % 5 == 0 ? 0.0 : std::pow(10.0, 3.0 * random.uniform() - 2.0);
    const Vec2 high = low + size * Vec2(random.uniform(), random.uniform());
    records.assign(1, 123456);  // What is there already stays.
    index.find(patch, low, high, records);
    ASSERT_EQ(records.front(), 123456u);
    EXPECT_TRUE(std::is_sorted(records.begin() + 1, records.end()));
    EXPECT_EQ(std::adjacent_find(records.begin(), records.end()), records.end());
    const std::vector<std::uint32_t> expected = meeting(footprints, patch, low, high);
    EXPECT_TRUE(std::includes(records.begin() + 1, records.end(), expected.begin(), expected.end()));
    all += expected.size();
    extra += records.size() - 1 - expected.size();
  }
  EXPECT_GT(all, 5000u);
  EXPECT_LT(extra, all);
}

TEST(RegionIndex, FindsInNoBoxThatIsNone) {
  const RegionIndex index(2, std::vector<PatchFootprint>{{5, 0, Vec2(1, 1), Vec2(2, 2)}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto found_in = [&](std::uint32_t patch, const Vec2& low, const Vec2& high) {
    std::vector<std::uint32_t> records;
    index.find(patch, low, high, records);
    return records;
  };
  EXPECT_THAT(found_in(0, Vec2(-infinity, -infinity), Vec2(infinity, infinity)), ElementsAre(5u));
  EXPECT_THAT(found_in(0, Vec2(2, 2), Vec2(3, 3)), ElementsAre(5u));
  EXPECT_THAT(found_in(1, Vec2(0, 0), Vec2(3, 3)), IsEmpty());
  EXPECT_THAT(found_in(0, Vec2(1.7, 1), Vec2(1.3, 2)), IsEmpty());
  EXPECT_THAT(found_in(0, Vec2(nan, 0), Vec2(3, 3)), IsEmpty());
  EXPECT_THAT(found_in(0, Vec2(0, 0), Vec2(3, nan)), IsEmpty());
  EXPECT_THAT(found_in(0, Vec2(3.5, 0), Vec2(4, 3)), IsEmpty());
}

TEST(RegionIndex, ReturnsFewOthersAndStaysSmall) {
  const std::vector<PatchFootprint> footprints = random_footprints(20000);
  const RegionIndex index(4, footprints);
  std::size_t candidates = 0;
  std::size_t covering = 0;
  for (std::size_t i = 0; i < footprints.size(); i += 50) {  // Where the records are.
    const Vec2 uv = 0.5 * (footprints[i].low + footprints[i].high);
    candidates += index.candidates(footprints[i].patch, uv).size();
    for (const PatchFootprint& f : footprints)
      covering += f.patch == footprints[i].patch && holds(f, uv) ? 1 : 0;
  }
  EXPECT_LT(candidates, 3 * covering);
  EXPECT_LT(index.memory(), 400 * footprints.size());
}

TEST(RegionIndex, DoesNotDependOnTheOrderOfTheInput) {
  std::vector<PatchFootprint> footprints = random_footprints(500);
  const RegionIndex index(4, footprints);
  std::reverse(footprints.begin(), footprints.end());
  const RegionIndex reversed(4, footprints);
  EXPECT_EQ(index.memory(), reversed.memory());
  test::SeededBits random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec2 uv(10.0 * random.uniform(), 3.0 * random.uniform());
    EXPECT_EQ(found(index, static_cast<std::uint32_t>(i % 4), uv),
              found(reversed, static_cast<std::uint32_t>(i % 4), uv));
  }
}

TEST(RegionIndex, TakesPointsLinesAndOneRecordInManyPatches) {
  const std::vector<PatchFootprint> footprints{{7, 0, Vec2(1, 1), Vec2(1, 1)},
                                               {7, 1, Vec2(0, 2), Vec2(5, 2)},
                                               {8, 1, Vec2(2, 2), Vec2(3, 2)},
                                               {7, 3, Vec2(0, 0), Vec2(1, 1)},
                                               {7, 3, Vec2(0, 0), Vec2(1, 1)}};
  const RegionIndex index(4, footprints);
  EXPECT_THAT(found(index, 0, Vec2(1, 1)), ElementsAre(7u));
  EXPECT_THAT(found(index, 1, Vec2(2.5, 2)), ElementsAre(7u, 8u));
  EXPECT_THAT(found(index, 3, Vec2(0.5, 0.5)), ElementsAre(7u));
}

TEST(RegionIndex, FindsNothingOutside) {
  const RegionIndex empty(3, {});
  EXPECT_THAT(found(empty, 2, Vec2(0, 0)), IsEmpty());
  const RegionIndex index(1, std::vector<PatchFootprint>{{0, 0, Vec2(1, 1), Vec2(2, 2)}});
  for (const double far : {-1e300, 0.99, 5.0, 1e300, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(found(index, 0, Vec2(far, 1.5)), IsEmpty()) << far;
    EXPECT_THAT(found(index, 0, Vec2(1.5, far)), IsEmpty()) << far;
  }
}

TEST(RegionIndex, RefusesBrokenFootprints) {
  using Footprints = std::vector<PatchFootprint>;
  EXPECT_THROW(RegionIndex(1, Footprints{{0, 1, Vec2(0, 0), Vec2(1, 1)}}), std::logic_error);
  EXPECT_THROW(RegionIndex(1, Footprints{{0, 0, Vec2(1, 0), Vec2(0, 1)}}), std::logic_error);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(RegionIndex(1, Footprints{{0, 0, Vec2(nan, 0), Vec2(1, 1)}}), std::logic_error);
  EXPECT_THROW(RegionIndex(1, Footprints{{0, 0, Vec2(0, 0), Vec2(1, 1), Vec2(nan, 0)}}), std::logic_error);
}

TEST(SpatialOrder, IsAPermutationThatKeepsNeighboursTogether) {
  const std::vector<PatchFootprint> footprints = random_footprints(2000);
  const std::vector<std::uint32_t> order = spatial_order(2002, footprints);  // Two lie nowhere.
  std::vector<std::uint32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> all(2002);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(sorted, all);
  EXPECT_EQ(order[2000], 2000u);
  EXPECT_EQ(order[2001], 2001u);
  double steps = 0.0;
  double unordered_steps = 0.0;
  for (std::size_t i = 1; i < 2000; ++i) {
    EXPECT_LE(footprints[order[i - 1]].patch, footprints[order[i]].patch);
    steps += (footprints[order[i]].low - footprints[order[i - 1]].low).norm();
    unordered_steps += (footprints[i].low - footprints[i - 1].low).norm();
  }
  EXPECT_LT(steps, 0.2 * unordered_steps);
}

// Every point that the walk says is inside the ellipse is in the footprint of its patch, and the index
// finds the record there.
TEST(PatchFootprints, HoldTheWalkedEllipse) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    const SurfaceMesh mesh = build_surface_mesh(soup);
    const PatchAtlas atlas = build_patch_atlas(mesh);
    test::SeededBits random(2);
    for (int i = 0; i < 20; ++i) {
      const auto face = static_cast<std::uint32_t>(random.below(mesh.face_count()));
      const Vec2 radii(0.05 + random.uniform(), 0.05 + 0.3 * random.uniform());
      const Vec3 centre = Vec3::Constant(1.0 / 3.0);
      const SurfaceWalk walk =
          walk_surface(mesh, make_ellipse(mesh, face, centre, Vec3(1.0, 2.1, 3.2), radii));
      const std::vector<PatchFootprint> footprints = patch_footprints(atlas, walk, radii, 42);
      for (std::size_t f = 1; f < footprints.size(); ++f)
        EXPECT_LT(footprints[f - 1].patch, footprints[f].patch);
      const RegionIndex index(atlas.patch_count(), footprints);
      for (const WalkedFace& walked : walk.faces) {
        for (int j = 0; j < 20; ++j) {
          double b1 = random.uniform();
          double b2 = random.uniform();
          if (b1 + b2 > 1.0) {
            b1 = 1.0 - b1;
            b2 = 1.0 - b2;
          }
          const Vec3 b(1.0 - b1 - b2, b1, b2);
          const Vec2 p = b[0] * walked.corners[0] + b[1] * walked.corners[1] + b[2] * walked.corners[2];
          if (p.cwiseQuotient(radii).norm() > 1.0) continue;
          const PatchPoint point{atlas.patch_of(walked.face), atlas.uv(walked.face, b)};
          EXPECT_THAT(found(index, point.patch, point.uv), ElementsAre(42u));
          std::vector<std::uint32_t> records;
          index.covering(point, records);
          EXPECT_THAT(records, ElementsAre(42u));
        }
      }
    }
  }
}

TEST(PatchFootprints, AreTightOnAPlane) {
  const SurfaceMesh mesh =
      build_surface_mesh(test::make_height_field([](double, double) { return 0.0; }, 20, 0.5));
  const PatchAtlas atlas = build_patch_atlas(mesh);
  ASSERT_EQ(atlas.patch_count(), 1u);
  const Vec2 radii(0.2, 0.1);
  const std::uint32_t face = 420;
  const Vec3 centre = Vec3::Constant(1.0 / 3.0);
  const SurfaceEllipse ellipse = make_ellipse(mesh, face, centre, Vec3(1, 0.4, 0), radii);
  const auto footprints = patch_footprints(atlas, walk_surface(mesh, ellipse), radii, 0);
  ASSERT_EQ(footprints.size(), 1u);
  const Vec2 uv = atlas.uv(face, centre);
  const Frame& frame = atlas.patch(0).frame;
  for (int axis = 0; axis < 2; ++axis) {
    const Vec3& direction = axis == 0 ? frame.tangent : frame.bitangent;
    const double half = std::hypot(radii.x() * direction.dot(ellipse.frame.tangent),
                                   radii.y() * direction.dot(ellipse.frame.bitangent));
    EXPECT_NEAR(footprints[0].high[axis] - uv[axis], half, 0.01 * half);
    EXPECT_NEAR(uv[axis] - footprints[0].low[axis], half, 0.01 * half);
  }
  EXPECT_LT((footprints[0].center - uv).norm(), 1e-9);
  const Mat2 axes = footprints[0].shape.inverse();
  EXPECT_NEAR(std::abs(axes.determinant()), radii.prod(), 1e-5 * radii.prod()) << "the ellipse alone";
}

}  // namespace
}  // namespace vrc
