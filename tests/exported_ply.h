// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support.h"

namespace vrc::test {

/// A slow reader of little-endian PLY meshes: scalars of the vertices, and triangles with their scalars.
struct ExportedPly {
  std::vector<std::string> vertex_properties, face_properties;  ///< "float x"; without the index list.
  std::vector<std::map<std::string, double>> vertices, faces;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

class ExportedPlyReader {
 public:
  explicit ExportedPlyReader(std::string bytes) : bytes_(std::move(bytes)) {}

  ExportedPly read() {
    ExportedPly ply;
    std::size_t counts[2] = {0, 0};
    read_header(ply, counts);
    for (std::size_t v = 0; v < counts[0]; ++v) ply.vertices.push_back(scalars(ply.vertex_properties));
    for (std::size_t f = 0; f < counts[1]; ++f) {
      if (take<std::uint8_t>() != 3) throw std::runtime_error("a face is no triangle");
      auto& triangle = ply.triangles.emplace_back();
      for (auto& index : triangle) index = static_cast<std::uint32_t>(take<std::int32_t>());
      ply.faces.push_back(scalars(ply.face_properties));
    }
    if (at_ != bytes_.size()) throw std::runtime_error("bytes after the last face");
    return ply;
  }

 private:
  void read_header(ExportedPly& ply, std::size_t* counts) {
    const std::size_t end = bytes_.find("end_header\n");
    if (end == std::string::npos) throw std::runtime_error("no header");
    std::istringstream header(bytes_.substr(0, end));
    bool in_faces = false;
    for (std::string line; std::getline(header, line);) {
      std::istringstream words(line);
      std::string keyword, type, name;
      words >> keyword >> type >> name;
      if (keyword == "element") {
        in_faces = type == "face";
        counts[in_faces ? 1 : 0] = std::stoul(name);
      } else if (keyword == "property" && type != "list") {
        (in_faces ? ply.face_properties : ply.vertex_properties).push_back(type + " " + name);
      }
    }
    at_ = end + std::strlen("end_header\n");
  }

  std::map<std::string, double> scalars(const std::vector<std::string>& properties) {
    std::map<std::string, double> result;
    for (const std::string& property : properties) {
      const std::string name = property.substr(property.find(' ') + 1);
      if (property.starts_with("float ")) result[name] = static_cast<double>(take<float>());
      if (property.starts_with("int ")) result[name] = take<std::int32_t>();
      if (property.starts_with("uchar ")) result[name] = take<std::uint8_t>();
    }
    return result;
  }

  template <typename T>
  T take() {
    T value;
    if (at_ + sizeof(T) > bytes_.size()) throw std::runtime_error("the file is too short");
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }

  std::string bytes_;
  std::size_t at_ = 0;
};

inline ExportedPly read_exported_ply(const std::filesystem::path& path) {
  return ExportedPlyReader(read_file(path)).read();
}

}  // namespace vrc::test
