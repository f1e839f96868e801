// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/scene_charts.h"

#include <algorithm>

#include "geometry/surface_mesh.h"

namespace vrc {
namespace {

constexpr int kWordsPerTriangle = 8;
constexpr int kPatchWord = 6;

/// Projection stretches by at most 1 / cos(cone angle), which costs a search little.
PatchAtlasOptions chart_options() {
  PatchAtlasOptions options;
  options.direct_faces = 0;
  options.direct_stretch = options.max_stretch;
  return options;
}

bool reflects(const Scene& scene, std::uint32_t first, std::size_t count) {
  const auto faces = scene.triangles().subspan(first, count);
  return std::ranges::any_of(faces, [&](const SceneTriangle& t) {
    return !scene.bsdfs()[static_cast<std::size_t>(t.material)].lobes.empty();
  });
}

}  // namespace

SceneCharts::SceneCharts(const Scene& scene) : scene_(&scene), triangles_(scene.triangle_count()) {
  static_assert(sizeof(Triangle) == kWordsPerTriangle * sizeof(float));
  atlases_.resize(scene.surface_count());
  for (std::size_t s = 0; s < scene.surface_count(); ++s) {
    const SurfaceMesh& mesh = scene.surface_mesh(s);
    const std::uint32_t first = scene.first_triangle(s);
    first_patch_.push_back(static_cast<std::uint32_t>(patch_surface_.size()));
    if (!reflects(scene, first, mesh.face_count())) continue;
    atlases_[s] = std::make_unique<const PatchAtlas>(build_patch_atlas(mesh, chart_options()));
    const PatchAtlas& atlas = *atlases_[s];
    for (std::size_t face = 0; face < mesh.face_count(); ++face) {
      Triangle& t = triangles_[first + face];
      t.patch = static_cast<std::int32_t>(first_patch_[s] + atlas.patch_of(face));
      for (int k = 0; k < 3; ++k) {
        t.uv[2 * k] = static_cast<float>(atlas.uv(face, k).x());
        t.uv[2 * k + 1] = static_cast<float>(atlas.uv(face, k).y());
      }
    }
    patch_surface_.insert(patch_surface_.end(), atlas.patch_count(), static_cast<std::uint32_t>(s));
  }
}

std::size_t SceneCharts::face_count(std::uint32_t patch) const {
  const std::uint32_t surface = patch_surface_[patch];
  return atlases_[surface]->faces(patch - first_patch_[surface]).size();
}

Vec2 SceneCharts::uv(std::uint32_t triangle, double u, double v) const {
  const Triangle& t = triangles_[triangle];
  const Vec2 a(t.uv[0], t.uv[1]), b(t.uv[2], t.uv[3]), c(t.uv[4], t.uv[5]);
  return a + u * (b - a) + v * (c - a);
}

ChartPoint16 SceneCharts::locate(I16 active, I16 triangle, F16 u, F16 v) const {
  const I16 base = select(active, triangle, I16{}) * kWordsPerTriangle;
  const auto word = [&](int offset) { return gather(triangles_.front().uv, base + offset); };
  const auto coordinate = [&](int axis) {
    const F16 a = word(axis);
    return a + u * (word(axis + 2) - a) + v * (word(axis + 4) - a);
  };
  return {select(active, bits(word(kPatchWord)), splat(-1)), coordinate(0), coordinate(1)};
}

}  // namespace vrc
