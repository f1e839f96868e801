// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/surface_export.h"
#include "surface_export_check.h"

namespace vrc {
namespace {

void append_value(std::string& line, const SurfaceArray& array, std::size_t index) {
  std::visit(
      [&](const auto& values) {
        const auto value = values[index];
        const auto word = static_cast<std::size_t>(value);
        if (word < array.words.size()) {
          line += array.words[word];
        } else {
          fmt::format_to(std::back_inserter(line), "{}", value);  // the shortest that reads back the same
        }
      },
      array.values);
}

}  // namespace

void write_surface_csv(const std::filesystem::path& path, const SurfaceExport& surface) {
  check_surface_export(surface);
  std::string text = "x,y,z";
  for (const SurfaceArray& array : surface.vertex_arrays) {
    for (const std::string& name : array.components) text += "," + name;
  }
  text += "\n";
  for (std::size_t v = 0; v < surface.positions.size(); ++v) {
    const Vec3f& p = surface.positions[v];
    fmt::format_to(std::back_inserter(text), "{},{},{}", p.x(), p.y(), p.z());
    for (const SurfaceArray& array : surface.vertex_arrays) {
      const std::size_t width = array.components.size();
      for (std::size_t c = 0; c < width; ++c) {
        text += ",";
        append_value(text, array, v * width + c);
      }
    }
    text += "\n";
  }
  write_file_atomically(path, text);
}

void write_surface(const std::filesystem::path& path, const SurfaceExport& surface) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".ply") return write_surface_ply(path, surface);
  if (extension == ".vtp") return write_surface_vtp(path, surface);
  VRC_CHECK(extension == ".csv", "extension {}", extension);
  write_surface_csv(path, surface);
}

}  // namespace vrc
