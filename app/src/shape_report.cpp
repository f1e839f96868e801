// SPDX-License-Identifier: GPL-3.0-or-later
#include "shape_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "geometry/self_intersections.h"
#include "geometry/surface_mesh.h"

namespace vrc {
namespace {

using Json = nlohmann::ordered_json;

CreaseCounts count_creases(std::span<const std::uint8_t> creases) {
  CreaseCounts counts;
  for (const std::uint8_t reasons : creases) {
    counts.edges += reasons != 0 ? 1 : 0;
    counts.boundary += (reasons & kCreaseBoundary) != 0 ? 1 : 0;
    counts.material += (reasons & kCreaseMaterial) != 0 ? 1 : 0;
    counts.non_manifold += (reasons & kCreaseNonManifold) != 0 ? 1 : 0;
    counts.angle += (reasons & kCreaseAngle) != 0 ? 1 : 0;
    counts.normals += (reasons & kCreaseNormals) != 0 ? 1 : 0;
  }
  return counts;
}

IntersectingPolygons intersecting_polygons(const SurfaceMesh& mesh) {
  const SelfIntersections found = find_self_intersections(mesh);
  IntersectingPolygons result{found.pair_count, {}};
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& [a, b] : found.first_pairs) {
    pairs.insert(std::minmax({mesh.source_polygon(a), mesh.source_polygon(b)}));
  }
  result.first.assign(pairs.begin(), pairs.end());
  return result;
}

Json vector_json(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json bounds_json(const Box3& box) {
  if (box.isEmpty()) return nullptr;
  return {{"min", vector_json(box.min())}, {"max", vector_json(box.max())}};
}

Json report_json(const ShapeReport& report) {
  const MeshReport& mesh = report.mesh;
  Json json{
      {"id", report.id},
      {"polygons", report.polygons},
      {"positions", report.positions},
      {"triangles", mesh.faces},
      {"vertices", mesh.vertices},
      {"edges", mesh.edges},
      {"materials", report.materials},
      {"has_normals", report.has_normals},
      {"has_uvs", report.has_uvs},
      {"bounds", bounds_json(mesh.bounds)},
      {"area", mesh.area},
      {"components", mesh.components},
      {"genus", mesh.genus},
      {"watertight", mesh.watertight},
      {"boundary_edges", mesh.boundary_edges},
      {"boundary_loops", mesh.boundary_loops},
      {"triangulated_polygons", mesh.triangulated_polygons},
      {"welded_vertices", mesh.welded_vertices},
      {"isolated_vertices", mesh.isolated_vertices},
      {"degenerate_faces", mesh.degenerate_faces},
      {"duplicate_faces", mesh.duplicate_faces},
      {"non_manifold_edges", mesh.non_manifold_edges},
      {"non_manifold_vertices", mesh.non_manifold_vertices},
      {"orientation_cuts", mesh.orientation_cuts},
      {"flipped_faces", mesh.flipped_faces},
      {"vertex_copies", mesh.vertex_copies},
      {"regions", report.regions},
      {"sectors", report.sectors},
      {"creases",
       {{"edges", report.creases.edges},
        {"boundary", report.creases.boundary},
        {"material", report.creases.material},
        {"non_manifold", report.creases.non_manifold},
        {"angle", report.creases.angle},
        {"normals", report.creases.normals}}},
  };
  if (report.intersections) {
    json["self_intersections"] = {{"triangle_pairs", report.intersections->triangle_pairs},
                                  {"first_polygons", report.intersections->first}};
  }
  return json;
}

class TextBlock {
 public:
  template <typename... Arguments>
  void line(std::string_view name, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    text_ += fmt::format("  {:<24}{}\n", name, fmt::format(format, std::forward<Arguments>(arguments)...));
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string vector_text(const Vec3& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x(), v.y(), v.z());
}

void add_size_lines(TextBlock& block, const ShapeReport& report) {
  const MeshReport& mesh = report.mesh;
  block.line("polygons", "{} ({} with more than three corners)", report.polygons, mesh.triangulated_polygons);
  block.line("triangles", "{}", mesh.faces);
  block.line("vertices", "{} ({} in the file)", mesh.vertices, report.positions);
  block.line("edges", "{}", mesh.edges);
  block.line("materials", "{}", report.materials);
  block.line("normals, uvs", "{}, {}", report.has_normals ? "supplied" : "none",
             report.has_uvs ? "supplied" : "none");
  if (mesh.bounds.isEmpty()) {
    block.line("bounds", "none");
  } else {
    block.line("bounds", "{} to {}", vector_text(mesh.bounds.min()), vector_text(mesh.bounds.max()));
  }
  block.line("area", "{:.6g}", mesh.area);
}

void add_topology_lines(TextBlock& block, const ShapeReport& report) {
  const MeshReport& mesh = report.mesh;
  block.line("components", "{}", mesh.components);
  block.line("genus", "{}", mesh.genus);
  block.line("watertight", "{}", mesh.watertight ? "yes" : "no");
  block.line("boundary loops", "{} ({} edges)", mesh.boundary_loops, mesh.boundary_edges);
  block.line("smooth regions", "{}", report.regions);
  block.line("crease edges", "{}", report.creases.edges);
  block.line("  by angle", "{}", report.creases.angle);
  block.line("  by normals", "{}", report.creases.normals);
  block.line("  by material", "{}", report.creases.material);
  block.line("  boundary", "{}", report.creases.boundary);
  block.line("  non-manifold, cut", "{}", report.creases.non_manifold);
}

void add_defect_lines(TextBlock& block, const ShapeReport& report) {
  const MeshReport& mesh = report.mesh;
  block.line("degenerate faces", "{}", mesh.degenerate_faces);
  block.line("duplicate faces", "{}", mesh.duplicate_faces);
  block.line("non-manifold edges", "{}", mesh.non_manifold_edges);
  block.line("non-manifold vertices", "{}", mesh.non_manifold_vertices);
  block.line("orientation cuts", "{}", mesh.orientation_cuts);
  block.line("flipped faces", "{}", mesh.flipped_faces);
  block.line("isolated vertices", "{}", mesh.isolated_vertices);
  block.line("welded vertices", "{}", mesh.welded_vertices);
  block.line("vertex copies", "{}", mesh.vertex_copies);
  if (!report.intersections) return;
  block.line("self-intersections", "{} pairs of triangles", report.intersections->triangle_pairs);
  std::string list;
  for (const auto& [a, b] : report.intersections->first) {
    list += fmt::format("{}{} and {}", list.empty() ? "" : ", ", a, b);
  }
  if (!list.empty()) block.line("  first polygons", "{}", list);
}

}  // namespace

ShapeReport inspect_shape(const ShapeDescription& shape, const ShapeReportOptions& options) {
  SurfaceMeshOptions mesh_options;
  mesh_options.creases.crease_angle = options.crease_angle;
  mesh_options.face_normals = shape.face_normals;
  const SurfaceMesh mesh(shape.soup, mesh_options);
  ShapeReport report;
  report.id = shape.id;
  report.polygons = shape.soup.face_count();
  report.positions = shape.soup.positions.size();
  const auto& materials = shape.soup.face_material;
  report.materials = materials.empty() ? std::min<std::size_t>(1, report.polygons)
                                       : std::set(materials.begin(), materials.end()).size();
  report.has_normals = !shape.soup.corner_normal.empty();
  report.has_uvs = !shape.soup.corner_uv.empty();
  report.mesh = mesh.report();
  report.regions = mesh.region_count();
  report.sectors = mesh.sector_count();
  report.creases = count_creases(mesh.creases());
  if (options.self_intersections) report.intersections = intersecting_polygons(mesh);
  return report;
}

std::string reports_as_text(const std::string& file, std::span<const ShapeReport> reports) {
  std::string text;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    TextBlock block;
    add_size_lines(block, reports[i]);
    add_topology_lines(block, reports[i]);
    add_defect_lines(block, reports[i]);
    text += fmt::format("{}{}: shape {} of {}: {}\n{}", i == 0 ? "" : "\n", file, i + 1, reports.size(),
                        reports[i].id.empty() ? "(no id)" : reports[i].id, block.text());
  }
  return text;
}

std::string reports_as_json(const std::string& file, const ShapeReportOptions& options,
                            std::span<const ShapeReport> reports) {
  Json shapes = Json::array();
  for (const ShapeReport& report : reports) shapes.push_back(report_json(report));
  const Json json{{"file", file}, {"crease_angle", options.crease_angle}, {"shapes", std::move(shapes)}};
  // Names may hold bytes that are no UTF-8; they are replaced rather than refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vrc
