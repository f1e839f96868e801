// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/frame.h"
#include "geometry/curvature.h"
#include "geometry/surface_mesh.h"

namespace vrc {

struct Surface {
  std::uint32_t first_triangle;
  SurfaceMesh mesh;
  std::optional<CurvatureField> curvature;  // none where every face is flat

  Surface(std::uint32_t first, const PolygonSoup& soup, const SurfaceMeshOptions& options)
      : first_triangle(first), mesh(soup, options) {}
};

namespace {

constexpr float kMinimumCosine = 1e-3f;
/// Interpolated normals closer than this to the geometric one are not worth interpolating.
constexpr double kFlatCosine = 1.0 - 1e-9;

/// Word indices of the triangle records are 32-bit.
constexpr std::size_t kMaxTriangles = 100'000'000;
constexpr int kWordsPerTriangle = sizeof(SceneTriangle) / sizeof(float);
static_assert(sizeof(SceneTriangle) == 64);

/// Reads words of the triangle records, sixteen triangles at once.
struct TriangleReader {
  const float* words;
  I16 base;

  TriangleReader(std::span<const SceneTriangle> triangles, I16 triangle)
      : words(triangles.front().p0), base(triangle * kWordsPerTriangle) {}
  [[nodiscard]] F16 word(int offset) const { return gather(words, base + offset); }
  [[nodiscard]] V3x16 vector(int offset) const { return {word(offset), word(offset + 1), word(offset + 2)}; }
  [[nodiscard]] I16 integer(int offset) const { return bits(word(offset)); }
};

constexpr int kP0 = 0, kE1 = 3, kE2 = 6, kNormal = 9, kMaterial = 12, kLight = 13, kRegion = 14, kSmooth = 15;

template <typename Array>
void store(Array& to, const Vec3& v) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(v[i]);
}

/// A shading normal turned just enough to be seen from `w`.
Vec3 visible_normal(const Vec3& n, const Vec3& w) {
  const double cosine = n.dot(w);
  if (cosine >= kMinimumCosine) return n;
  return (n + (kMinimumCosine - cosine) * w).normalized();
}

}  // namespace

Scene::Scene(const SceneDescription& description) : camera_(description.camera), film_(description.film) {
  for (const Material& material : description.materials) bsdfs_.emplace_back(material);

  std::vector<EmissiveTriangle> emissive;
  std::vector<float> vertices;
  Box3 bounds;
  for (const ShapeDescription& shape : description.shapes) {
    add_shape(description, shape, emissive, vertices);
    bounds.extend(shape.soup.bounds());
  }
  if (triangles_.size() > kMaxTriangles) {
    throw InputError(
        description.source, 0,
        fmt::format("{} triangles are too many; {} is the most", triangles_.size(), kMaxTriangles));
  }
  if (triangles_.empty()) throw InputError(description.source, 0, "the scene has no surfaces; add a shape");
  radius_ = 0.5 * bounds.diagonal().norm();
  if (!(radius_ > 0.0))
    throw InputError(description.source, 0, "all surfaces lie in one point; check the scale");

  std::vector<std::uint32_t> indices(3 * triangles_.size());
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
  lights_ = Lights(std::move(emissive), description.delta_lights, description.environment, radius_);
  tracer_ = std::make_unique<RayTracer>(vertices, indices);
}

void Scene::add_shape(const SceneDescription& description, const ShapeDescription& shape,
                      std::vector<EmissiveTriangle>& lights, std::vector<float>& vertices) {
  SurfaceMeshOptions options;
  options.face_normals = shape.face_normals;
  options.creases.crease_angle = description.crease_angle;
  surfaces_.push_back(
      std::make_unique<Surface>(static_cast<std::uint32_t>(triangles_.size()), shape.soup, options));
  Surface& surface = *surfaces_.back();
  const SurfaceMesh& mesh = surface.mesh;
  bool curved = false;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto [p0, p1, p2] = mesh.positions(face);
    const Vec3 normal = mesh.face_normal(face);
    SceneTriangle t;
    store(t.p0, p0);
    store(t.e1, p1 - p0);
    store(t.e2, p2 - p0);
    store(t.normal, normal);
    const std::size_t slot = mesh.material(face);
    VRC_CHECK(slot < shape.materials.size(), "shape {} uses material slot {}", shape.id, slot);
    t.material = static_cast<std::int32_t>(shape.materials[slot]);
    t.region = region_count_ + static_cast<std::int32_t>(mesh.region(face));
    t.light = -1;
    const Rgb emission = slot < shape.emission.size() ? shape.emission[slot] : Rgb::Zero().eval();
    if (emission.maxCoeff() > 0.0f) {
      t.light = static_cast<std::int32_t>(lights.size());
      lights.push_back({p0.cast<float>(), (p1 - p0).cast<float>(), (p2 - p0).cast<float>(),
                        normal.cast<float>(), static_cast<float>(mesh.face_area(face)), emission,
                        static_cast<std::uint32_t>(triangles_.size())});
    }
    t.smooth = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3& n = mesh.corner_normal(face, k);
      if (n.dot(normal) < kFlatCosine) t.smooth = 1;
      curved |= t.smooth != 0;
      for (int i = 0; i < 3; ++i) corner_normals_.push_back(static_cast<float>(n[i]));
    }
    for (const Vec3& p : {p0, p1, p2}) {
      for (int i = 0; i < 3; ++i) vertices.push_back(static_cast<float>(p[i]));
    }
    triangles_.push_back(t);
  }
  region_count_ += static_cast<std::int32_t>(mesh.region_count());
  if (!curved) return;
  CurvatureOptions curvature;
  curvature.method = description.curvature;
  surface.curvature = estimate_curvature(mesh, curvature);
}

Scene::~Scene() = default;

const SurfaceMesh& Scene::surface_mesh(std::size_t surface) const { return surfaces_[surface]->mesh; }

std::uint32_t Scene::first_triangle(std::size_t surface) const { return surfaces_[surface]->first_triangle; }

std::size_t Scene::surface_of(std::uint32_t triangle) const {
  // Of shapes without faces, which begin where the next one does, the last is found.
  const auto next =
      std::ranges::upper_bound(surfaces_, triangle, {}, [](const auto& s) { return s->first_triangle; });
  return static_cast<std::size_t>(next - surfaces_.begin()) - 1;
}

SurfacePoint16 Scene::intersect(I16 active, const Ray16& ray, RayTracer::Coherence coherence) const {
  const Hit16 hit = tracer_->intersect(active, ray, coherence);
  SurfacePoint16 p;
  p.hit = hit.hit;
  p.triangle = hit.triangle;
  p.t = hit.t;
  p.u = select(hit.hit, hit.u, F16{});
  p.v = select(hit.hit, hit.v, F16{});
  const TriangleReader reader(triangles_, p.triangle);
  // The hit point comes from barycentrics: t is inaccurate on skinny triangles.
  p.position = reader.vector(kP0) + reader.vector(kE1) * p.u + reader.vector(kE2) * p.v;
  const V3x16 outside = reader.vector(kNormal);
  const I16 back = dot(outside, ray.direction) > 0.0f;
  p.geometric_normal = select(back, -outside, outside);
  p.normal = p.geometric_normal;
  const I16 smooth = hit.hit & (reader.integer(kSmooth) != 0);
  if (any(smooth)) {
    V3x16 n = normalize(corner_normal(p.triangle, 0) * (1.0f - p.u - p.v) +
                        corner_normal(p.triangle, 1) * p.u + corner_normal(p.triangle, 2) * p.v);
    n = select(back, -n, n);
    const V3x16 wo = -normalize(ray.direction);
    const F16 cosine = dot(n, wo);
    n = select(cosine < kMinimumCosine, normalize(n + wo * (kMinimumCosine - cosine)), n);
    p.normal = select(smooth, n, p.normal);
  }
  p.material = reader.integer(kMaterial);
  p.light = select(hit.hit, reader.integer(kLight), splat(-1));
  p.region = reader.integer(kRegion);

  I16 reflects{};
  for_each_distinct(hit.hit, p.material, [&](I16 mask, std::size_t id) {
    if (!bsdfs_[id].lobes.empty()) reflects |= bsdfs_[id].two_sided ? mask : (mask & ~back);
  });
  p.scatters = reflects;
  return p;
}

V3x16 Scene::corner_normal(I16 triangle, int corner) const {
  const I16 index = triangle * 9 + 3 * corner;
  const float* n = corner_normals_.data();
  return {gather(n, index), gather(n, index + 1), gather(n, index + 2)};
}

F16 Scene::normal_curvature(I16 triangle, const V3x16& direction, const V3x16& facing) const {
  const TriangleReader reader(triangles_, triangle);
  const I16 smooth = reader.integer(kSmooth) != 0;
  if (!any(smooth)) return F16{};
  const V3x16 e1 = reader.vector(kE1), e2 = reader.vector(kE2);
  const F16 e11 = dot(e1, e1), e12 = dot(e1, e2), e22 = dot(e2, e2);
  const F16 d1 = dot(e1, direction), d2 = dot(e2, direction);
  const F16 determinant = e11 * e22 - e12 * e12;
  const I16 known = smooth & (determinant > 0.0f);
  const F16 inverse = 1.0f / select(known, determinant, splat(1.0f));
  // The projected direction is u e1 + v e2; normals change linearly over the triangle.
  const F16 u = (e22 * d1 - e12 * d2) * inverse, v = (e11 * d2 - e12 * d1) * inverse;
  const V3x16 along = e1 * u + e2 * v;
  const V3x16 n0 = corner_normal(triangle, 0);
  const V3x16 turn = (corner_normal(triangle, 1) - n0) * u + (corner_normal(triangle, 2) - n0) * v;
  const F16 outside = dot(turn, along) / max(dot(along, along), 1e-20f);
  return select(known, select(dot(reader.vector(kNormal), facing) < 0.0f, -outside, outside), F16{});
}

Ray16 Scene::shadow_ray(const SurfacePoint16& p, const LightSample16& light) const {
  const V3x16 origin = lifted(p);
  // Towards the sampled point itself: a parallel ray would meet a close light before its end.
  const V3x16 to_light = p.position + light.direction * light.distance - origin;
  return {origin, to_light, (1.0f - 1e-4f) - ray_offset() / max(light.distance, 1e-30f)};
}

SurfacePoint Scene::surface_point(std::uint32_t triangle, float u, float v, const Vec3& viewer) const {
  const Surface& surface = *surfaces_[surface_of(triangle)];
  const std::size_t face = triangle - surface.first_triangle;
  const auto c = surface.mesh.positions(face);
  const Vec3 b(1.0 - u - v, u, v);
  const SceneTriangle& t = triangles_[triangle];
  SurfacePoint p;
  p.triangle = triangle;
  p.u = u;
  p.v = v;
  p.material = t.material;
  p.region = t.region;
  p.position = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
  const Vec3 to_viewer = (viewer - p.position).normalized();
  const Vec3 outside = surface.mesh.face_normal(face);
  const double side = outside.dot(to_viewer) < 0.0 ? -1.0 : 1.0;
  p.geometric_normal = side * outside;
  p.normal = p.geometric_normal;
  if (t.smooth == 0) return p;
  Vec3 n = Vec3::Zero();
  for (int k = 0; k < 3; ++k) n += b[k] * surface.mesh.corner_normal(face, k);
  p.normal = visible_normal(side * n.normalized(), to_viewer);
  // Seen from inside, the normal turns the other way.
  const Frame frame = Frame::around(p.normal);
  Eigen::Matrix<double, 3, 2> tangents;
  tangents << frame.tangent, frame.bitangent;
  p.shape_operator = side * tangents.transpose() * surface.curvature->shape_operator(face, b) * tangents;
  return p;
}

std::optional<SurfacePoint> Scene::seen_at(double film_x, double film_y) const {
  I16 first{};
  first[0] = -1;
  const Ray16 ray = {splat3(camera_.origin), splat3(camera_.direction(film_x, film_y)), splat(1e17f)};
  const SurfacePoint16 p = intersect(first, ray, RayTracer::Coherence::kIncoherent);
  if (p.scatters[0] == 0) return std::nullopt;
  return surface_point(static_cast<std::uint32_t>(p.triangle[0]), p.u[0], p.v[0], camera_.origin);
}

}  // namespace vrc
