// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string>

#include "geometry/shapes.h"

namespace vrc::test {

/// Six quads, closed; the corner order points outwards.
inline const std::string kCubeObj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// The cube without its top.
inline const std::string kOpenBoxObj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A soup's positions and faces as OBJ, without normals.
inline std::string obj_text(const PolygonSoup& soup) {
  std::string text;
  for (const Vec3& p : soup.positions) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  for (std::size_t f = 0; f < soup.face_count(); ++f) {
    text += "f";
    for (const std::uint32_t v : soup.face_positions(f)) text += fmt::format(" {}", v + 1);
    text += "\n";
  }
  return text;
}

/// A sphere around the origin as ascii PLY.
inline std::string sphere_ply(double radius, int subdivision) {
  const PolygonSoup soup = make_sphere(Vec3::Zero(), radius, subdivision);
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      soup.positions.size(), soup.face_count());
  for (const Vec3& p : soup.positions) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  for (std::size_t f = 0; f < soup.face_count(); ++f) {
    text += std::to_string(soup.face_positions(f).size());
    for (const std::uint32_t v : soup.face_positions(f)) text += fmt::format(" {}", v);
    text += "\n";
  }
  return text;
}

}  // namespace vrc::test
