// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/bsdf.h"
#include "transport/lights.h"
#include "transport/ray_tracer.h"
#include "transport/scene_description.h"

namespace vrc {

/// One triangle as the kernels read it: sixteen 32-bit words, one cache line.
struct alignas(64) SceneTriangle {
  float p0[3], e1[3], e2[3];  ///< Vertex and the edges to the other two.
  float normal[3];            ///< Unit geometric normal, on the outside.
  std::int32_t material;
  std::int32_t light;   ///< Index into Lights::triangles(), or -1.
  std::int32_t region;  ///< Smooth region: what no crease, border or material change divides.
  std::int32_t smooth;  ///< 1: shading normals differ from the geometric one.
};

/// Sixteen points where rays met the scene, oriented towards the rays' origins.
struct SurfacePoint16 {
  I16 hit;
  I16 scatters;  ///< Hit, and the side that the ray met reflects light.
  I16 triangle;
  F16 t, u, v;
  V3x16 position;
  V3x16 geometric_normal;
  V3x16 normal;  ///< Shading normal; its cosine with the direction to the ray's origin is positive.
  I16 material, light, region;
};

/// A surface point in double precision, for records.
struct SurfacePoint {
  Vec3 position;
  Vec3 geometric_normal;               ///< Unit, on the side of the viewer.
  Vec3 normal;                         ///< Unit shading normal, on the side of the viewer.
  Mat2 shape_operator = Mat2::Zero();  ///< In Frame::around(normal); positive where convex. [1/length]
  std::uint32_t triangle = 0;
  float u = 0.0f, v = 0.0f;
  std::int32_t material = 0;
  std::int32_t region = 0;
};

class SurfaceMesh;
struct Surface;  // a shape's half-edge mesh and curvature

/// Surfaces, lights and the camera, ready to trace. Immutable but for the camera.
class Scene {
 public:
  /// Throws InputError when nothing can be rendered (no faces, coordinates too large for tracing).
  explicit Scene(const SceneDescription& description);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  [[nodiscard]] const Camera& camera() const { return camera_; }
  /// For the next frame of a fly-through; not while another thread uses the scene.
  void look_through(const Camera& camera) { camera_ = camera; }
  [[nodiscard]] const FilmDescription& film() const { return film_; }
  [[nodiscard]] const std::vector<Bsdf>& bsdfs() const { return bsdfs_; }
  [[nodiscard]] const Lights& lights() const { return lights_; }
  [[nodiscard]] const RayTracer& tracer() const { return *tracer_; }
  [[nodiscard]] std::size_t triangle_count() const { return triangles_.size(); }
  [[nodiscard]] std::span<const SceneTriangle> triangles() const { return triangles_; }
  [[nodiscard]] double radius() const { return radius_; }  ///< Of the bounding sphere of all surfaces.

  /// The half-edge meshes of the shapes: triangle t is face t - first_triangle(s) of its surface s.
  [[nodiscard]] std::size_t surface_count() const { return surfaces_.size(); }
  [[nodiscard]] const SurfaceMesh& surface_mesh(std::size_t surface) const;
  [[nodiscard]] std::uint32_t first_triangle(std::size_t surface) const;
  [[nodiscard]] std::size_t surface_of(std::uint32_t triangle) const;
  [[nodiscard]] float ray_offset() const { return static_cast<float>(1e-5 * radius_); }

  [[nodiscard]] SurfacePoint16 intersect(I16 active, const Ray16& ray, RayTracer::Coherence coherence) const;
  [[nodiscard]] SurfacePoint surface_point(std::uint32_t triangle, float u, float v,
                                           const Vec3& viewer) const;
  /// The reflecting surface that the camera sees at a film position; nothing elsewhere.
  [[nodiscard]] std::optional<SurfacePoint> seen_at(double film_x, double film_y) const;

  /// Normal curvatures of triangles along directions, which are projected into them; positive where the side
  /// of the normals `facing` is convex, 0 on flat triangles. [1/length]
  [[nodiscard]] F16 normal_curvature(I16 triangle, const V3x16& direction, const V3x16& facing) const;

  /// Origin of rays that leave a point: lifted off the surface, towards the viewer's side.
  [[nodiscard]] V3x16 lifted(const SurfacePoint16& p) const {
    return p.position + p.geometric_normal * ray_offset();
  }
  /// From the lifted point to just before the sampled point of a light.
  [[nodiscard]] Ray16 shadow_ray(const SurfacePoint16& p, const LightSample16& light) const;

 private:
  void add_shape(const SceneDescription& description, const ShapeDescription& shape,
                 std::vector<EmissiveTriangle>& lights, std::vector<float>& vertices);
  /// Shading normals of triangles at a corner, on the outside.
  [[nodiscard]] V3x16 corner_normal(I16 triangle, int corner) const;

  Camera camera_;
  FilmDescription film_;
  std::vector<Bsdf> bsdfs_;
  std::vector<SceneTriangle> triangles_;
  std::vector<float> corner_normals_;               ///< Nine floats a triangle.
  std::vector<std::unique_ptr<Surface>> surfaces_;  ///< By their first triangle.
  std::int32_t region_count_ = 0;
  Lights lights_;
  double radius_ = 1.0;
  std::unique_ptr<RayTracer> tracer_;
};

}  // namespace vrc
