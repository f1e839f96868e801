// SPDX-License-Identifier: GPL-3.0-or-later
// Records light the surface that they reach, and nothing else.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/shapes.h"
#include "placement/place_records.h"
#include "placement/tile.h"
#include "placement_support.h"
#include "support.h"

namespace vrc {
namespace {

PolygonSoup make_soup(std::vector<Vec3> positions, const std::vector<std::vector<std::uint32_t>>& faces) {
  PolygonSoup soup;
  soup.source = "test";
  soup.positions = std::move(positions);
  for (const auto& face : faces) soup.add_face(face);
  return soup;
}

/// One two-sided shape under a camera far above, and its charts.
struct Surface {
  Scene scene;
  std::shared_ptr<const SceneCharts> charts = std::make_shared<const SceneCharts>(scene);

  explicit Surface(PolygonSoup soup, const Vec3& viewer = Vec3(0.3, -0.4, 50.0))
      : scene(describe(std::move(soup), viewer)) {}

  static SceneDescription describe(PolygonSoup soup, const Vec3& viewer) {
    SceneDescription description;
    ShapeDescription shape;
    shape.soup = std::move(soup);
    shape.materials = {0};
    description.shapes.push_back(std::move(shape));
    description.materials.push_back({"matte", {LambertLobe{}}, true});
    description.camera.origin = viewer;
    return description;
  }

  [[nodiscard]] SurfacePoint at(std::uint32_t triangle, float u, float v) const {
    return scene.surface_point(triangle, u, v, scene.camera().origin);
  }
  [[nodiscard]] SurfacePoint random_point(test::SeededBits& bits) const {
    const auto u = static_cast<float>(bits.uniform()), v = static_cast<float>(bits.uniform());
    return at(static_cast<std::uint32_t>(bits.below(scene.triangle_count())), u + v > 1 ? 1 - u : u,
              u + v > 1 ? 1 - v : v);
  }
};

RadianceRecord record_at(const Scene& scene, const SurfacePoint& point, double radius1, double radius2,
                         double max_deviation = 0.15) {
  RadianceRecord record;
  record.site = make_site(scene, point, 1);
  const Frame& frame = record.site.frame;
  record.region = {point.position,
                   point.normal,
                   frame.tangent,
                   frame.bitangent,
                   radius1,
                   radius2,
                   std::min(radius1, radius2),
                   std::cos(max_deviation)};
  for (Jet2& j : record.radiance) j.value = 1.0;
  return record;
}

/// Sixteen or fewer points as a renderer meets them.
Tile tile_of(const std::vector<SurfacePoint>& points) {
  Tile tile;
  tile.pixels = {Pixel{0, 0}};
  SurfacePoint16 p{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto lane = static_cast<int>(i);
    p.hit[lane] = p.scatters[lane] = -1;
    p.triangle[lane] = static_cast<std::int32_t>(points[i].triangle);
    p.u[lane] = points[i].u;
    p.v[lane] = points[i].v;
    p.region[lane] = points[i].region;
    const auto store = [&](V3x16& to, const Vec3& v) {
      to.x[lane] = static_cast<float>(v.x());
      to.y[lane] = static_cast<float>(v.y());
      to.z[lane] = static_cast<float>(v.z());
    };
    store(p.position, points[i].position);
    store(p.normal, points[i].normal);
  }
  tile.points = {p};
  return tile;
}

/// Weight that the only record of the cache has at each point.
std::vector<double> weights_at(const RadianceCache& cache, const std::vector<SurfacePoint>& points,
                               double support) {
  std::vector<double> result;
  for (std::size_t first = 0; first < points.size(); first += kLanes) {
    const std::vector<SurfacePoint> some(
        points.begin() + static_cast<std::ptrdiff_t>(first),
        points.begin() + static_cast<std::ptrdiff_t>(std::min(first + kLanes, points.size())));
    const Tile tile = tile_of(some);
    F16 sum{};
    TileRecords(cache, tile)
        .for_each(0, static_cast<float>(support), Deviation::kAccepted,
                  [&](const PackedRecord&, const Coverage16& c) { sum += c.weight; });
    for (std::size_t i = 0; i < some.size(); ++i)
      result.push_back(static_cast<double>(sum[static_cast<int>(i)]));
  }
  return result;
}

RadianceCache one_record(const Surface& surface, const RadianceRecord& record) {
  const std::vector<RadianceRecord> records = {record};
  return {surface.charts, records, reaches_of(*surface.charts, records, kWideSupport)};
}

/// z = height(x, y) over [-1, 1]^2.
PolygonSoup height_field(int n, const std::function<double(double, double)>& height) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n - 1.0, y = 2.0 * j / n - 1.0;
      positions.emplace_back(x, y, height(x, y));
    }
  }
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return make_soup(std::move(positions), faces);
}

TEST(SurfaceLookUp, GivesEveryPointInReachItsWeight) {
  const std::vector<PolygonSoup> soups = {
      height_field(40, [](double x, double y) { return 0.2 * std::sin(3 * x) * std::cos(2 * y); }),
      make_sphere(Vec3::Zero(), 1.0, 24), make_cylinder(-Vec3::UnitX(), Vec3::UnitX(), 0.5, 64),
      height_field(1, [](double, double) { return 0.0; })};
  test::SeededBits bits(5);
  int positive = 0;
  for (const PolygonSoup& soup : soups) {
    const Surface surface(soup);
    for (int run = 0; run < 30; ++run) {
      const RadianceRecord record = record_at(surface.scene, surface.random_point(bits),
                                              0.02 + 0.2 * bits.uniform(), 0.02 + 0.2 * bits.uniform());
      const RadianceCache cache = one_record(surface, record);
      std::vector<SurfacePoint> points;
      for (int i = 0; i < 640; ++i) points.push_back(surface.random_point(bits));
      const std::vector<double> found = weights_at(cache, points, 1.4);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double expected = weight(record.region, points[i].position, points[i].normal, 1.4);
        EXPECT_NEAR(found[i], expected, 3e-4) << "run " << run << ", point " << i;
        positive += expected > 0.0;
      }
    }
  }
  EXPECT_GT(positive, 500);
}

/// Points of triangles that satisfy `wanted`, for which Euclidean distance and normals alone would take
/// the record, and the number of those that it lights.
struct Leaks {
  int tempting = 0;
  int lit = 0;
};

template <typename Wanted>
Leaks count_leaks(const Surface& surface, const RadianceRecord& record, const Wanted& wanted) {
  const RadianceCache cache = one_record(surface, record);
  test::SeededBits bits(9);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 20000; ++i) {
    const SurfacePoint p = surface.random_point(bits);
    if (wanted(p) && weight(record.region, p.position, p.normal, kWideSupport) > 0.0) points.push_back(p);
  }
  Leaks leaks;
  for (const double w : weights_at(cache, points, kWideSupport)) {
    ++leaks.tempting;
    leaks.lit += w > 0.0;
  }
  return leaks;
}

TEST(SurfaceLookUp, StaysOnOneStepOfAStair) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  constexpr int kSteps = 10;
  for (int i = 0; i <= kSteps; ++i) {
    for (const double z : {0.01 * i, 0.01 * (i + 1)}) {
      positions.emplace_back(-1.0, 0.2 * i - 1.0, z);
      positions.emplace_back(1.0, 0.2 * i - 1.0, z);
    }
  }
  for (std::uint32_t i = 0; i + 1 < positions.size() / 2; ++i)
    faces.push_back({2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2});
  const Surface surface(make_soup(positions, faces));
  const std::uint32_t middle = 2 * (2 * 5 + 1);  // the tread of the fifth step
  const SurfacePoint center = surface.at(middle, 0.3f, 0.3f);
  ASSERT_GT(center.normal.z(), 0.99);
  const Leaks leaks = count_leaks(surface, record_at(surface.scene, center, 0.5, 0.5),
                                  [&](const SurfacePoint& p) { return p.region != center.region; });
  EXPECT_GT(leaks.tempting, 100);
  EXPECT_EQ(leaks.lit, 0);
}

TEST(SurfaceLookUp, StaysOnOneOfTwoSheetsThatFaceTheSameWay) {
  const PolygonSoup sheet = height_field(20, [](double, double) { return 0.0; });
  PolygonSoup both = sheet;
  const auto base = static_cast<std::uint32_t>(sheet.positions.size());
  for (const Vec3& p : sheet.positions) both.positions.push_back(p + Vec3(0, 0, -0.003));
  for (std::size_t f = 0; f < sheet.face_count(); ++f) {
    std::vector<std::uint32_t> face;
    for (const std::uint32_t v : sheet.face_positions(f)) face.push_back(base + v);
    both.add_face(face);
  }
  const Surface surface(both);
  const SurfacePoint center = surface.at(420, 0.4f, 0.3f);
  const Leaks leaks = count_leaks(
      surface, record_at(surface.scene, center, 0.3, 0.3),
      [&](const SurfacePoint& p) { return std::abs(p.position.z() - center.position.z()) > 0.001; });
  EXPECT_GT(leaks.tempting, 1000);
  EXPECT_EQ(leaks.lit, 0);
}

/// A ramp that winds around the z axis, each turn 1 % of the record's radius above the one before: one
/// smooth surface that faces up everywhere.
TEST(SurfaceLookUp, StaysOnOneTurnOfARamp) {
  constexpr int kTurns = 3, kPerTurn = 48;
  constexpr double kRadius = 0.3, kPitch = 0.01 * kRadius;
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i <= kTurns * kPerTurn; ++i) {
    const double angle = 2.0 * kPi * i / kPerTurn;
    for (const double r : {0.5, 0.75, 1.0})
      positions.emplace_back(r * std::cos(angle), r * std::sin(angle), kPitch * i / kPerTurn);
  }
  for (std::uint32_t i = 0; i < kTurns * kPerTurn; ++i) {
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t a = 3 * i + k;
      faces.push_back({a, a + 1, a + 4, a + 3});
    }
  }
  const Surface surface(make_soup(positions, faces));
  const SurfacePoint center = surface.at(2 * 2 * (kPerTurn + 10), 0.4f, 0.3f);
  const Leaks leaks =
      count_leaks(surface, record_at(surface.scene, center, kRadius, kRadius), [&](const SurfacePoint& p) {
        EXPECT_EQ(p.region, center.region);
        return std::abs(p.position.z() - center.position.z()) > 0.7 * kPitch;
      });
  EXPECT_GT(leaks.tempting, 1000);
  EXPECT_EQ(leaks.lit, 0);
}

/// A plane cut along a diagonal slit that ends in the surface: around the record the two sides are apart.
TEST(SurfaceLookUp, DoesNotCrossASlit) {
  constexpr int kCells = 40;
  PolygonSoup soup = height_field(kCells, [](double, double) { return 0.0; });
  // The vertices of the diagonal exist twice, but for the first quarter.
  const auto at = [](int i, int j) { return static_cast<std::uint32_t>(j * (kCells + 1) + i); };
  std::map<std::uint32_t, std::uint32_t> twin;
  for (int i = kCells / 4; i <= kCells; ++i) {
    twin[at(i, i)] = static_cast<std::uint32_t>(soup.positions.size());
    soup.positions.push_back(soup.positions[at(i, i)] + Vec3(1e-5, -1e-5, 0.0));
  }
  PolygonSoup cut;
  cut.source = "slit";
  cut.positions = soup.positions;
  for (std::size_t f = 0; f < soup.face_count(); ++f) {
    const auto quad = soup.face_positions(f);
    for (const auto& triangle :
         {std::array{quad[0], quad[1], quad[2]}, std::array{quad[0], quad[2], quad[3]}}) {
      Vec3 middle = Vec3::Zero();
      for (const std::uint32_t v : triangle) middle += soup.positions[v] / 3.0;
      std::vector<std::uint32_t> face(triangle.begin(), triangle.end());
      for (std::uint32_t& v : face) {
        if (middle.x() > middle.y() && twin.contains(v)) v = twin[v];
      }
      cut.add_face(face);
    }
  }
  const Surface surface(cut);
  test::SeededBits bits(2);
  SurfacePoint center = surface.random_point(bits);
  while ((center.position - Vec3(0.52, 0.48, 0.0)).norm() > 0.03) center = surface.random_point(bits);
  ASSERT_GT(center.position.x(), center.position.y());
  const Leaks leaks = count_leaks(surface, record_at(surface.scene, center, 0.1, 0.1),
                                  [](const SurfacePoint& p) { return p.position.x() < p.position.y(); });
  EXPECT_GT(leaks.tempting, 100);
  EXPECT_EQ(leaks.lit, 0);
}

TEST(SurfaceLookUp, StaysOnItsSideOfThinWallsAndInsideCorners) {
  // A wall of thickness 0.001 on a floor: floor left, wall left, top, wall right, floor right.
  const std::vector<Vec2> profile = {{-1, 0},       {-0.0005, 0}, {-0.0005, 0.5},
                                     {0.0005, 0.5}, {0.0005, 0},  {1, 0}};
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (const Vec2& p : profile) {
    positions.emplace_back(p.x(), -1.0, p.y());
    positions.emplace_back(p.x(), 1.0, p.y());
  }
  for (std::uint32_t i = 0; i + 1 < profile.size(); ++i)
    faces.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  const Surface surface(make_soup(positions, faces), Vec3(-5.0, 0.0, 5.0));
  for (const std::uint32_t triangle : {0u, 2u}) {
    const SurfacePoint center = surface.at(triangle, 0.4f, 0.3f);
    const Leaks leaks = count_leaks(surface, record_at(surface.scene, center, 0.9, 0.9, 1.5),
                                    [&](const SurfacePoint& p) { return p.region != center.region; });
    EXPECT_GT(leaks.tempting, 100);
    EXPECT_EQ(leaks.lit, 0) << "triangle " << triangle;
  }
}

}  // namespace
}  // namespace vrc
