// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <cstring>
#include <numeric>
#include <string_view>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/base64.h"
#include "io/surface_export.h"
#include "io/xml_text.h"
#include "surface_export_check.h"

namespace vrc {
namespace {

constexpr const char* vtk_type(float) { return "Float32"; }
constexpr const char* vtk_type(std::int32_t) { return "Int32"; }
constexpr const char* vtk_type(std::uint8_t) { return "UInt8"; }

template <typename T>
void append_data_array(std::string& xml, const std::string& name, std::size_t components,
                       const std::vector<T>& values) {
  xml += fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="binary">)",
                     vtk_type(T{}), xml_escaped(name), components);
  // An 8-byte length, then the values, encoded as one piece.
  const std::uint64_t size = values.size() * sizeof(T);
  std::string bytes(sizeof(size) + size, '\0');
  std::memcpy(bytes.data(), &size, sizeof(size));
  if (size > 0) std::memcpy(bytes.data() + sizeof(size), values.data(), size);
  xml += base64(bytes);
  xml += "</DataArray>\n";
}

bool has_components(const SurfaceArray& array, const std::vector<std::string>& components) {
  return array.components == components;
}

/// "PointData" or "CellData"; names the arrays that ParaView uses by itself.
void append_arrays(std::string& xml, const char* tag, const std::vector<SurfaceArray>& arrays) {
  xml += fmt::format("<{}", tag);
  for (const SurfaceArray& array : arrays) {
    if (has_components(array, {"nx", "ny", "nz"}))
      xml += fmt::format(R"( Normals="{}")", xml_escaped(array.name));
    if (has_components(array, {"s", "t"})) xml += fmt::format(R"( TCoords="{}")", xml_escaped(array.name));
  }
  xml += ">\n";
  for (const SurfaceArray& array : arrays) {
    std::visit(
        [&](const auto& values) { append_data_array(xml, array.name, array.components.size(), values); },
        array.values);
  }
  xml += fmt::format("</{}>\n", tag);
}

void append_points_as_cells(std::string& xml, std::size_t count) {
  std::vector<std::int32_t> connectivity(count), offsets(count);
  std::iota(connectivity.begin(), connectivity.end(), 0);
  std::iota(offsets.begin(), offsets.end(), 1);
  xml += "<Verts>\n";
  append_data_array(xml, "connectivity", 1, connectivity);
  append_data_array(xml, "offsets", 1, offsets);
  xml += "</Verts>\n";
}

void append_polygons(std::string& xml, const std::vector<Triangle>& triangles) {
  std::vector<std::int32_t> connectivity, offsets;
  connectivity.reserve(3 * triangles.size());
  offsets.reserve(triangles.size());
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t v : triangle) connectivity.push_back(static_cast<std::int32_t>(v));
    offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
  }
  xml += "<Polys>\n";
  append_data_array(xml, "connectivity", 1, connectivity);
  append_data_array(xml, "offsets", 1, offsets);
  xml += "</Polys>\n";
}

}  // namespace

void write_surface_vtp(const std::filesystem::path& path, const SurfaceExport& surface) {
  check_surface_export(surface);
  constexpr bool kLittle = std::endian::native == std::endian::little;
  const std::size_t points_as_cells = is_point_cloud(surface) ? surface.positions.size() : 0;
  std::string xml = "<?xml version=\"1.0\"?>\n";
  if (!surface.comment.empty()) xml += "<!-- " + surface.comment + " -->\n";
  xml += fmt::format(R"(<VTKFile type="PolyData" version="1.0" byte_order="{}" header_type="UInt64">)",
                     kLittle ? "LittleEndian" : "BigEndian");
  xml += fmt::format(
      "\n<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
      surface.positions.size(), points_as_cells, surface.triangles.size());
  append_arrays(xml, "PointData", surface.vertex_arrays);
  append_arrays(xml, "CellData", surface.face_arrays);
  std::vector<float> coordinates;
  coordinates.reserve(3 * surface.positions.size());
  for (const Vec3f& p : surface.positions) coordinates.insert(coordinates.end(), p.begin(), p.end());
  xml += "<Points>\n";
  append_data_array(xml, "Points", 3, coordinates);
  xml += "</Points>\n";
  append_points_as_cells(xml, points_as_cells);
  append_polygons(xml, surface.triangles);
  xml += "</Piece>\n</PolyData>\n</VTKFile>\n";
  write_file_atomically(path, xml);
}

}  // namespace vrc
