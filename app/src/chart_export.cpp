// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_export.h"

#include <fmt/format.h>

#include <algorithm>

#include "surface_colors.h"

namespace vrc {
namespace {

/// Numbers the distinct corners (one sector in one chart at one place of it) in the order of the faces.
class CornerTable {
 public:
  explicit CornerTable(const PatchAtlas& atlas) : atlas_(atlas), by_sector_(atlas.mesh().sector_count()) {}

  [[nodiscard]] std::uint32_t vertex_of(std::size_t face, int k) {
    const Vec2 uv = atlas_.layout_uv(face, k);
    auto& known = by_sector_[atlas_.mesh().corner_sector(face, k)];
    const auto same = [&](std::uint32_t v) { return corners_[v].uv == uv; };
    const auto found = std::ranges::find_if(known, same);
    if (found != known.end()) return *found;
    corners_.push_back({face, k, uv});
    known.push_back(static_cast<std::uint32_t>(corners_.size() - 1));
    return known.back();
  }

  struct Corner {
    std::size_t face;
    int k;
    Vec2 uv;  ///< In the layout, where charts lie apart.
  };
  [[nodiscard]] const std::vector<Corner>& corners() const { return corners_; }

 private:
  const PatchAtlas& atlas_;
  std::vector<Corner> corners_;
  std::vector<std::vector<std::uint32_t>> by_sector_;
};

void add_vertices(SurfaceExport& surface, const PatchAtlas& atlas, const CornerTable& table) {
  const SurfaceMesh& mesh = atlas.mesh();
  const double scale = 1.0 / atlas.layout_size().maxCoeff();
  std::vector<float> normals, uvs;
  for (const CornerTable::Corner& corner : table.corners()) {
    const std::uint32_t vertex = mesh.triangle(corner.face)[static_cast<std::size_t>(corner.k)];
    surface.positions.push_back(mesh.position(vertex).cast<float>());
    for (const double c : mesh.corner_normal(corner.face, corner.k)) normals.push_back(static_cast<float>(c));
    for (const double c : corner.uv) uvs.push_back(static_cast<float>(c * scale));
  }
  surface.vertex_arrays.push_back({"Normals", {"nx", "ny", "nz"}, std::move(normals)});
  surface.vertex_arrays.push_back({"uv", {"s", "t"}, std::move(uvs)});
}

void add_face_arrays(SurfaceExport& surface, const PatchAtlas& atlas,
                     const std::function<Rgb(std::size_t)>& color) {
  const SurfaceMesh& mesh = atlas.mesh();
  std::vector<std::uint8_t> colors;
  std::vector<std::int32_t> patches, materials;
  std::vector<float> stretches, areas;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (const std::uint8_t c : color8(color(f))) colors.push_back(c);
    patches.push_back(static_cast<std::int32_t>(atlas.patch_of(f)));
    materials.push_back(static_cast<std::int32_t>(mesh.material(f)));
    const Vec2 s = atlas.singular_values(f);
    stretches.push_back(static_cast<float>(s[0] / s[1]));
    areas.push_back(static_cast<float>(area_distortion(atlas, f)));
  }
  surface.face_arrays.push_back({"color", {"red", "green", "blue"}, std::move(colors)});
  surface.face_arrays.push_back({"patch", {"patch"}, std::move(patches)});
  surface.face_arrays.push_back({"stretch", {"stretch"}, std::move(stretches)});
  surface.face_arrays.push_back({"area_distortion", {"area_distortion"}, std::move(areas)});
  surface.face_arrays.push_back({"material", {"material"}, std::move(materials)});
}

}  // namespace

double area_distortion(const PatchAtlas& atlas, std::size_t face) {
  const double ratio = atlas.singular_values(face).prod();
  return std::max(ratio, 1.0 / ratio);
}

SurfaceExport chart_export(const PatchAtlas& atlas, const std::function<Rgb(std::size_t)>& color) {
  SurfaceExport surface;
  surface.comment = fmt::format("vrc charts; one unit of s and t is {:.9g} units of length",
                                atlas.layout_size().maxCoeff());
  CornerTable table(atlas);
  for (std::size_t f = 0; f < atlas.mesh().face_count(); ++f) {
    surface.triangles.push_back({table.vertex_of(f, 0), table.vertex_of(f, 1), table.vertex_of(f, 2)});
  }
  add_vertices(surface, atlas, table);
  add_face_arrays(surface, atlas, color);
  return surface;
}

}  // namespace vrc
