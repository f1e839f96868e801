// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/surface_export.h"
#include "surface_export_check.h"

namespace vrc {
namespace {

constexpr const char* ply_type(float) { return "float"; }
constexpr const char* ply_type(std::int32_t) { return "int"; }
constexpr const char* ply_type(std::uint8_t) { return "uchar"; }

template <typename T>
void put(std::string& bytes, T value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

void put_element(std::string& bytes, const std::vector<SurfaceArray>& arrays, std::size_t index) {
  for (const SurfaceArray& array : arrays) {
    const std::size_t width = array.components.size();
    std::visit(
        [&](const auto& values) {
          for (std::size_t c = 0; c < width; ++c) put(bytes, values[index * width + c]);
        },
        array.values);
  }
}

std::string property_lines(const std::vector<SurfaceArray>& arrays) {
  std::string lines;
  for (const SurfaceArray& array : arrays) {
    const char* type =
        std::visit([](const auto& v) { return ply_type(typename std::decay_t<decltype(v)>::value_type{}); },
                   array.values);
    for (const std::string& name : array.components) lines += fmt::format("property {} {}\n", type, name);
  }
  return lines;
}

std::string header_of(const SurfaceExport& surface) {
  constexpr bool kLittle = std::endian::native == std::endian::little;
  std::string header =
      fmt::format("ply\nformat {} 1.0\n", kLittle ? "binary_little_endian" : "binary_big_endian");
  if (!surface.comment.empty()) header += "comment " + surface.comment + "\n";
  header += fmt::format("element vertex {}\n", surface.positions.size());
  header += "property float x\nproperty float y\nproperty float z\n" + property_lines(surface.vertex_arrays);
  if (!is_point_cloud(surface)) {
    header += fmt::format("element face {}\n", surface.triangles.size());
    header += "property list uchar int vertex_indices\n" + property_lines(surface.face_arrays);
  }
  return header + "end_header\n";
}

}  // namespace

void write_surface_ply(const std::filesystem::path& path, const SurfaceExport& surface) {
  check_surface_export(surface);
  std::string bytes = header_of(surface);
  for (std::size_t v = 0; v < surface.positions.size(); ++v) {
    for (const float coordinate : surface.positions[v]) put(bytes, coordinate);
    put_element(bytes, surface.vertex_arrays, v);
  }
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    put(bytes, std::uint8_t{3});
    for (const std::uint32_t v : surface.triangles[f]) put(bytes, static_cast<std::int32_t>(v));
    put_element(bytes, surface.face_arrays, f);
  }
  write_file_atomically(path, bytes);
}

}  // namespace vrc
