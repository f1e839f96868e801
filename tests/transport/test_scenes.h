// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "geometry/polygon_soup.h"
#include "geometry/shapes.h"
#include "transport/scene.h"

namespace vrc {

inline Material matte(float reflectance, bool two_sided = false) {
  return {"matte", {LambertLobe{Rgb::Constant(reflectance)}}, two_sided};
}

/// Turns outside to inside.
inline PolygonSoup inside_out(PolygonSoup soup) {
  for (std::size_t f = 0; f < soup.face_count(); ++f) {
    const auto begin = soup.face_begin[f], end = soup.face_begin[f + 1];
    for (auto* corners : {&soup.corner_position, &soup.corner_normal, &soup.corner_uv}) {
      if (!corners->empty()) std::reverse(corners->begin() + begin, corners->begin() + end);
    }
  }
  for (Vec3& n : soup.normals) n = -n;
  return soup;
}

inline PolygonSoup placed(PolygonSoup soup, const Vec3& scale, const Vec3& offset) {
  Mat4 m = Mat4::Identity();
  m.topLeftCorner<3, 3>() = scale.asDiagonal();
  m.topRightCorner<3, 1>() = offset;
  transform(soup, m);
  return soup;
}

/// Adds a shape with a material of its own.
inline void add_shape(SceneDescription& scene, PolygonSoup soup, const Material& material,
                      float emission = 0.0f, bool face_normals = true) {
  ShapeDescription shape;
  shape.soup = std::move(soup);
  shape.materials = {static_cast<std::uint32_t>(scene.materials.size())};
  shape.emission = {Rgb::Constant(emission)};
  shape.face_normals = face_normals;
  scene.materials.push_back(material);
  scene.shapes.push_back(std::move(shape));
}

/// Sixteen equal rays.
inline Ray16 ray16(const Vec3& origin, const Vec3& direction, float t_max = 1e17f) {
  return {splat3(origin), splat3(direction), splat(t_max)};
}

}  // namespace vrc
