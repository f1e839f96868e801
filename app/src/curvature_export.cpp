// SPDX-License-Identifier: GPL-3.0-or-later
#include "curvature_export.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "curvature_values.h"
#include "surface_colors.h"

namespace vrc {
namespace {

constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());

float to_float(double value) { return static_cast<float>(std::clamp(value, -kLargest, kLargest)); }

template <typename Value>
SurfaceArray scalars(const std::string& name, std::size_t count, const Value& value) {
  std::vector<float> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = to_float(value(i));
  return {name, {name}, std::move(values)};
}

template <typename Value>
SurfaceArray vectors(const std::string& name, std::vector<std::string> components, std::size_t count,
                     const Value& value) {
  std::vector<float> values;
  values.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const double c : Vec3(value(i))) values.push_back(to_float(c));
  }
  return {name, std::move(components), std::move(values)};
}

SurfaceArray colors(std::size_t count, const std::function<Rgb(std::size_t)>& color) {
  std::vector<std::uint8_t> values;
  values.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const std::uint8_t c : color8(color(i))) values.push_back(c);
  }
  return {"color", {"red", "green", "blue"}, std::move(values)};
}

template <typename Number>
SurfaceArray numbers(const std::string& name, std::size_t count, const Number& number) {
  std::vector<std::int32_t> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<std::int32_t>(number(i));
  return {name, {name}, std::move(values)};
}

std::vector<SurfaceArray> sector_arrays(const SurfaceMesh& mesh, std::span<const PrincipalCurvatures> k,
                                        double max_normal_deviation,
                                        const std::function<Rgb(std::size_t)>& color) {
  const std::size_t count = k.size();
  const double diagonal = mesh.report().bounds.diagonal().norm();
  const auto quantity = [&](CurvatureQuantity q) {
    return [&k, q](std::size_t s) { return value_of(k[s], q); };
  };
  return {
      vectors("Normals", {"nx", "ny", "nz"}, count, [&](std::size_t s) { return mesh.sector_normal(s); }),
      colors(count, color),
      scalars("quality", count, quantity(CurvatureQuantity::kMax)),
      scalars("k1", count, quantity(CurvatureQuantity::kK1)),
      scalars("k2", count, quantity(CurvatureQuantity::kK2)),
      scalars("mean", count, quantity(CurvatureQuantity::kMean)),
      scalars("gauss", count, quantity(CurvatureQuantity::kGauss)),
      vectors("d1", {"d1x", "d1y", "d1z"}, count, [&](std::size_t s) { return k[s].direction1; }),
      vectors("d2", {"d2x", "d2y", "d2z"}, count, [&](std::size_t s) { return k[s].direction2; }),
      scalars("sh_radius", count,
              [&](std::size_t s) {
                const double largest = value_of(k[s], CurvatureQuantity::kMax);
                return largest * diagonal > max_normal_deviation ? max_normal_deviation / largest : diagonal;
              }),
  };
}

}  // namespace

SurfaceExport curvature_export(const PatchAtlas& atlas, std::span<const PrincipalCurvatures> sectors,
                               double max_normal_deviation, const std::function<Rgb(std::size_t)>& color) {
  const SurfaceMesh& mesh = atlas.mesh();
  SurfaceExport surface;
  surface.comment = "vrc curvature; quality is the largest absolute principal curvature";
  surface.positions.resize(mesh.sector_count());
  surface.triangles.resize(mesh.face_count());
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t sector = mesh.corner_sector(f, static_cast<int>(c));
      surface.triangles[f][c] = sector;
      surface.positions[sector] = mesh.position(mesh.triangle(f)[c]).cast<float>();
    }
  }
  surface.vertex_arrays = sector_arrays(mesh, sectors, max_normal_deviation, color);
  const std::size_t faces = mesh.face_count();
  surface.face_arrays = {
      numbers("patch", faces, [&](std::size_t f) { return atlas.patch_of(f); }),
      numbers("region", faces, [&](std::size_t f) { return mesh.region(f); }),
      numbers("material", faces, [&](std::size_t f) { return mesh.material(f); }),
  };
  return surface;
}

}  // namespace vrc
