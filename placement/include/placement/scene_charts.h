// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "geometry/patch_atlas.h"
#include "transport/scene.h"

namespace vrc {

/// Sixteen points in charts.
struct ChartPoint16 {
  I16 patch;  ///< Of SceneCharts; -1 where there is none.
  F16 u, v;   ///< [world units]
};

/// The charts of all surfaces of a scene that reflect light, numbered through: the parameter space in
/// which records are looked up. Projections are preferred to conformal maps, as only the search for
/// records happens here, and distances are taken in space. Refers to the scene, which must outlive it.
class SceneCharts {
 public:
  explicit SceneCharts(const Scene& scene);

  [[nodiscard]] const Scene& scene() const { return *scene_; }
  [[nodiscard]] std::size_t patch_count() const { return patch_surface_.size(); }
  /// kInvalidIndex on surfaces that reflect nothing.
  [[nodiscard]] std::uint32_t patch_of(std::uint32_t triangle) const {
    const std::int32_t patch = triangles_[triangle].patch;
    return patch < 0 ? kInvalidIndex : static_cast<std::uint32_t>(patch);
  }
  [[nodiscard]] std::size_t face_count(std::uint32_t patch) const;
  /// In the chart of the triangle's patch. [world units]
  [[nodiscard]] Vec2 uv(std::uint32_t triangle, double u, double v) const;
  [[nodiscard]] ChartPoint16 locate(I16 active, I16 triangle, F16 u, F16 v) const;

  /// Charts of a surface; its patch p is patch first_patch(surface) + p of the scene. Only for surfaces
  /// with charts.
  [[nodiscard]] const PatchAtlas& atlas(std::size_t surface) const { return *atlases_[surface]; }
  [[nodiscard]] std::uint32_t first_patch(std::size_t surface) const { return first_patch_[surface]; }

 private:
  struct alignas(32) Triangle {
    float uv[6] = {};  ///< Of the three corners.
    std::int32_t patch = -1;
    std::int32_t unused = 0;
  };

  const Scene* scene_;
  std::vector<std::unique_ptr<const PatchAtlas>> atlases_;  ///< Per surface.
  std::vector<std::uint32_t> first_patch_;                  ///< Per surface.
  std::vector<std::uint32_t> patch_surface_;                ///< Per patch.
  std::vector<Triangle> triangles_;
};

}  // namespace vrc
