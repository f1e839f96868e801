// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/false_color.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "transport/film_sampler.h"
#include "transport/ray_tracer.h"

namespace vrc {
namespace {

constexpr float kAmbient = 0.4f;  ///< Of the colour that a surface seen edge-on keeps.

// The lanes of a packet are a regular grid of 4 x 4 samples in a pixel.
F16 sample_x(int x) { return static_cast<float>(x) + (to_float(lane_index() & 3) + 0.5f) * 0.25f; }
F16 sample_y(int y) { return static_cast<float>(y) + (to_float(lane_index() >> 2) + 0.5f) * 0.25f; }

RayTracer make_tracer(std::span<const Vec3f> corners) {
  std::vector<float> coordinates;
  coordinates.reserve(3 * corners.size());
  for (const Vec3f& p : corners) coordinates.insert(coordinates.end(), p.begin(), p.end());
  std::vector<std::uint32_t> indices(corners.size());
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
  return {coordinates, indices};
}

/// `ray(x, y)` are the rays of a pixel; `shade(face, barycentric, direction)` is what one of them sees.
template <typename RayOf, typename Shade>
Image trace_pixels(int width, int height, const RayTracer& tracer, const RayOf& ray, const Shade& shade) {
  Image image(width, height, {"R", "G", "B"});
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const Ray16 rays = ray(x, y);
      const Hit16 hit = tracer.intersect(splat(-1), rays, RayTracer::Coherence::kCoherent);
      Rgb sum = Rgb::Zero();
      for (int lane = 0; lane < kLanes; ++lane) {
        if (hit.hit[lane] == 0) {
          sum += Rgb::Ones();
          continue;
        }
        const Vec3f b(1.0f - hit.u[lane] - hit.v[lane], hit.u[lane], hit.v[lane]);
        const Vec3 direction(rays.direction.x[lane], rays.direction.y[lane], rays.direction.z[lane]);
        sum += shade(static_cast<std::size_t>(hit.triangle[lane]), b.cast<double>().eval(), direction);
      }
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = sum[c] / static_cast<float>(kLanes);
    }
  });
  return image;
}

/// Takes the mesh to the unit ball around the origin, where single precision serves any mesh.
struct UnitScale {
  Vec3 center;
  double scale;

  explicit UnitScale(const Box3& box)
      : center(box.center()), scale(2.0 / std::max(box.diagonal().norm(), 1e-300)) {}
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return (p - center) * scale; }
};

float facing(const SurfaceMesh& mesh, std::size_t face, const Vec3& b, const Vec3& direction) {
  Vec3 n = Vec3::Zero();
  for (int k = 0; k < 3; ++k) n += b[k] * mesh.corner_normal(face, k);
  const double length = n.norm();
  return length > 0.0 ? static_cast<float>(std::abs(n.dot(direction)) / length) : 0.0f;
}

}  // namespace

Image render_false_color(const SurfaceMesh& mesh, const Camera& camera, const SurfaceColor& color) {
  VRC_CHECK(mesh.face_count() > 0, "a mesh without faces");
  const UnitScale scaled(mesh.report().bounds);
  std::vector<Vec3f> corners;
  corners.reserve(3 * mesh.face_count());
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (const Vec3& p : mesh.positions(f)) corners.push_back(scaled(p).cast<float>());
  }
  const RayTracer tracer = make_tracer(corners);
  const V3x16 origin = splat3(scaled(camera.origin));
  const auto ray = [&](int x, int y) {
    return Ray16{origin, camera_directions(camera, sample_x(x), sample_y(y)), splat(1e17f)};
  };
  const auto shade = [&](std::size_t face, const Vec3& b, const Vec3& direction) -> Rgb {
    return color(face, b) * (kAmbient + (1.0f - kAmbient) * facing(mesh, face, b, direction));
  };
  return trace_pixels(camera.width, camera.height, tracer, ray, shade);
}

Image render_flat_triangles(std::span<const Vec2> corners, const Vec2& size, int width, int height,
                            const SurfaceColor& color) {
  VRC_CHECK(!corners.empty() && corners.size() % 3 == 0, "{} corners", corners.size());
  VRC_CHECK(size.minCoeff() > 0.0, "a window of {} x {}", size.x(), size.y());
  constexpr double kMargin = 0.02;  // of the picture, on each side
  const double pixels = (1.0 - 2.0 * kMargin) * std::min(width / size.x(), height / size.y());
  const Vec2 offset = 0.5 * (Vec2(width, height) - pixels * size);
  std::vector<Vec3f> points;  // in pixels from the lower left
  points.reserve(corners.size());
  for (const Vec2& p : corners) {
    const Vec2 q = pixels * p + offset;
    points.emplace_back(static_cast<float>(q.x()), static_cast<float>(q.y()), 0.0f);
  }
  const RayTracer tracer = make_tracer(points);
  const auto ray = [&](int x, int y) {
    const V3x16 origin{sample_x(x), static_cast<float>(height) - sample_y(y), splat(1.0f)};
    return Ray16{origin, splat3(Vec3(0.0, 0.0, -1.0)), splat(2.0f)};
  };
  const auto shade = [&](std::size_t face, const Vec3& b, const Vec3&) { return color(face, b); };
  return trace_pixels(width, height, tracer, ray, shade);
}

}  // namespace vrc
