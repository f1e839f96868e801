// SPDX-License-Identifier: GPL-3.0-or-later
// Interpolated radiance does not jump where charts meet.
#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/surface_mesh.h"
#include "placement/place_records.h"
#include "real_meshes.h"
#include "render_support.h"
#include "shading/interpolate.h"

namespace vrc {
namespace {

/// A point on an edge between two charts, as a point of either face.
struct SeamPoint {
  std::array<SurfacePoint, 2> side;
};

/// Points of all edges between charts of one smooth region that face the camera.
std::vector<SeamPoint> seam_points(const SceneCharts& charts, std::size_t surface) {
  const Scene& scene = charts.scene();
  const SurfaceMesh& mesh = scene.surface_mesh(surface);
  const std::uint32_t first = scene.first_triangle(surface);
  std::vector<SeamPoint> points;
  const auto at = [&](std::uint32_t face, int k, double share) {
    Vec3 b = Vec3::Zero();
    b[k] = 1.0 - share;
    b[(k + 1) % 3] = share;
    return scene.surface_point(first + face, static_cast<float>(b[1]), static_cast<float>(b[2]),
                               scene.camera().origin);
  };
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = mesh.neighbour(face, k);
      if (other == kInvalidIndex || other < face || mesh.crease(mesh.edge(face, k)) != 0) continue;
      if (charts.patch_of(first + face) == charts.patch_of(first + other)) continue;
      int back = 0;
      while (mesh.edge(other, back) != mesh.edge(face, k)) ++back;
      const SeamPoint p = {{at(face, k, 0.375), at(other, back, 0.625)}};
      EXPECT_LT((p.side[0].position - p.side[1].position).norm(), 1e-6 * scene.radius());
      const Vec3 view = (scene.camera().origin - p.side[0].position).normalized();
      if (p.side[0].normal.dot(view) > 0.1 && mesh.face_normal(face).dot(view) > 0.05) points.push_back(p);
    }
  }
  return points;
}

/// The two sides in lanes 0 and 1.
Tile tile_of(const SeamPoint& seam, const Vec3& viewer) {
  SurfacePoint16 p{};
  for (int lane = 0; lane < 2; ++lane) {
    const SurfacePoint& from = seam.side[static_cast<std::size_t>(lane)];
    // The same point in space, so that only the charts differ.
    const SurfacePoint& same = seam.side[0];
    p.hit[lane] = p.scatters[lane] = -1;
    p.triangle[lane] = static_cast<std::int32_t>(from.triangle);
    p.u[lane] = from.u;
    p.v[lane] = from.v;
    p.region[lane] = from.region;
    const auto store = [lane](V3x16& to, const Vec3& v) {
      to.x[lane] = static_cast<float>(v.x());
      to.y[lane] = static_cast<float>(v.y());
      to.z[lane] = static_cast<float>(v.z());
    };
    store(p.position, same.position);
    store(p.normal, same.normal);
  }
  Tile tile;
  tile.pixels = {Pixel{0, 0}};
  CameraPacket packet{};
  packet.direction = splat3(Vec3((seam.side[0].position - viewer).normalized()));
  tile.packets = {packet};
  tile.points = {p};
  return tile;
}

void expect_no_seams(const SceneDescription& description, std::size_t surface, int least) {
  const Scene scene(description);
  const Camera& camera = scene.camera();
  const FilmSampler film(camera, scene.film(), 4, 1);
  CacheOptions options;
  options.error = 0.1;
  options.gather_rays = 1024;
  PlacementResult placed =
      place_records(scene, {0, 0, camera.width, camera.height, &film}, options, 1, 1, {});
  const RadianceCache cache(placed.charts, std::move(placed.records), placed.reaches, placed.brdfs);
  int compared = 0;
  for (const SeamPoint& seam : seam_points(cache.charts(), surface)) {
    const Tile tile = tile_of(seam, camera.origin);
    const V3x16 radiance = interpolate(TileRecords(cache, tile), 0, 2).radiance;
    const double scale = static_cast<double>(std::max(radiance.y[0], radiance.y[1]));
    if (!(scale > 0.0)) continue;
    ++compared;
    for (const F16& channel : {radiance.x, radiance.y, radiance.z})
      EXPECT_NEAR(channel[0], channel[1], 1e-5 * scale) << "at " << seam.side[0].position.transpose();
  }
  EXPECT_GE(compared, least);
}

SceneDescription torus_in_room() {
  SceneDescription scene = test::describe_scene("curved_room.xml", 64, 64);
  PolygonSoup soup;
  soup.source = "torus";
  constexpr std::uint32_t kRing = 64, kTube = 32;
  for (std::uint32_t j = 0; j < kRing; ++j) {
    for (std::uint32_t i = 0; i < kTube; ++i) {
      const double a = 2.0 * kPi * j / kRing, b = 2.0 * kPi * i / kTube;
      const Vec3 outward(std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b));
      soup.positions.push_back(Vec3(0.5, 0.5, 0.6) + 0.22 * Vec3(std::cos(a), std::sin(a), 0.0) +
                               0.1 * outward);
      soup.normals.push_back(outward);
      const auto at = [&](std::uint32_t ring, std::uint32_t tube) {
        return (ring % kRing) * kTube + tube % kTube;
      };
      soup.add_face(std::vector<std::uint32_t>{at(j, i), at(j + 1, i), at(j + 1, i + 1), at(j, i + 1)});
    }
  }
  soup.corner_normal = soup.corner_position;
  ShapeDescription shape = scene.shapes.back();
  shape.soup = soup;
  scene.shapes.push_back(shape);
  return scene;
}

TEST(Seams, AreInvisibleOnATorus) {
  const SceneDescription scene = torus_in_room();
  expect_no_seams(scene, scene.shapes.size() - 1, 50);
}

TEST(Seams, AreInvisibleOnTheBunny) {
  const auto meshes = test::real_meshes();
  const auto file = std::ranges::find_if(
      meshes, [](const auto& path) { return path.filename().string().find("bunny") != std::string::npos; });
  if (file == meshes.end())
    GTEST_SKIP() << "no bunny in shared/models beside the repository nor in /usr/share/glmark2/models";
  SceneReadOptions options;
  options.width = options.height = 64;
  const SceneDescription bunny = read_scene(*file, options);
  std::size_t surface = 0;
  for (std::size_t s = 0; s < bunny.shapes.size(); ++s) {
    if (bunny.shapes[s].soup.face_count() > bunny.shapes[surface].soup.face_count()) surface = s;
  }
  expect_no_seams(bunny, surface, 200);
}

}  // namespace
}  // namespace vrc
