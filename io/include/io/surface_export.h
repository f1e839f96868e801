// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/types.h"
#include "geometry/triangulate.h"

namespace vrc {

/// Values at the vertices or faces of an exported mesh: `components.size()` numbers each, interleaved.
struct SurfaceArray {
  std::string name;                     ///< In .vtp files.
  std::vector<std::string> components;  ///< In .ply files, each a property of its own: "d1x", "d1y", "d1z".
  std::variant<std::vector<float>, std::vector<std::int32_t>, std::vector<std::uint8_t>> values;
  std::vector<std::string> words = {};  ///< Written for the values 0, 1, 2 ... in .csv files.

  [[nodiscard]] std::size_t value_count() const {
    return std::visit([](const auto& v) { return v.size(); }, values);
  }
};

/// Triangles, or points when there are none, with arrays, as other programs open them. An array of the
/// components nx, ny, nz holds the normals; one of s, t the texture coordinates; one of red, green, blue
/// (8-bit sRGB) the colours.
struct SurfaceExport {
  std::string comment;  ///< One line of ASCII without "--": what the arrays mean.
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<SurfaceArray> vertex_arrays;
  std::vector<SurfaceArray> face_arrays;
};

/// Binary PLY in the byte order of this machine: x y z and the properties of the arrays; faces, if any,
/// as vertex_indices and theirs. Opens in MeshLab, Blender and CloudCompare.
/// Throws InputError when the path cannot be written.
void write_surface_ply(const std::filesystem::path& path, const SurfaceExport& surface);

/// VTK XML PolyData for ParaView, which reads no arrays from PLY files: binary in base64, not
/// compressed. Without faces every point is a cell of its own, as ParaView only draws cells.
/// Throws InputError when the path cannot be written.
void write_surface_vtp(const std::filesystem::path& path, const SurfaceExport& surface);

/// Text: a line of names as in .ply files, then one line for each vertex; numbers have the fewest digits
/// that give back the same value, with a point in every locale, and may be inf or nan. No faces.
/// Throws InputError when the path cannot be written.
void write_surface_csv(const std::filesystem::path& path, const SurfaceExport& surface);

/// By the extension, in any case, which must be .ply, .vtp or .csv.
void write_surface(const std::filesystem::path& path, const SurfaceExport& surface);

}  // namespace vrc
