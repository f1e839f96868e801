// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geometry/mesh_repair.h"
#include "transport/scene_description.h"

namespace vrc {

struct ShapeReportOptions {
  double crease_angle = 40.0;  ///< [degrees]
  bool self_intersections = false;
};

/// Pairs of polygons of the file that pass through each other, numbered from 0.
struct IntersectingPolygons {
  std::size_t triangle_pairs = 0;  ///< All of them.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first;
};

/// Edges that are creases; one edge may have several reasons.
struct CreaseCounts {
  std::size_t edges = 0;
  std::size_t boundary = 0, material = 0, non_manifold = 0, angle = 0, normals = 0;
};

/// What `vrc inspect` says of one shape.
struct ShapeReport {
  std::string id;
  std::size_t polygons = 0;   ///< In the file.
  std::size_t positions = 0;  ///< In the file.
  std::size_t materials = 0;  ///< That faces use.
  bool has_normals = false;
  bool has_uvs = false;
  MeshReport mesh;
  std::size_t regions = 0;  ///< Smooth parts, divided by creases.
  std::size_t sectors = 0;  ///< Shading normals.
  CreaseCounts creases;
  std::optional<IntersectingPolygons> intersections;
};

/// Throws InputError where the soup is invalid.
[[nodiscard]] ShapeReport inspect_shape(const ShapeDescription& shape, const ShapeReportOptions& options);

/// One block of aligned lines a shape.
[[nodiscard]] std::string reports_as_text(const std::string& file, std::span<const ShapeReport> reports);
[[nodiscard]] std::string reports_as_json(const std::string& file, const ShapeReportOptions& options,
                                          std::span<const ShapeReport> reports);

}  // namespace vrc
