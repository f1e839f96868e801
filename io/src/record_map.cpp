// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/record_map.h"

#include <bit>
#include <cmath>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/color.h"

namespace vrc {
namespace {

using Color8 = std::array<std::uint8_t, 3>;
constexpr Color8 kShColor{214, 39, 40};

/// Collects a binary PLY in the byte order of this machine, which the header names.
class PlyBuilder {
 public:
  explicit PlyBuilder(const std::string& comment)
      : bytes_(fmt::format(
            "ply\nformat {} 1.0\ncomment {}\n",
            std::endian::native == std::endian::little ? "binary_little_endian" : "binary_big_endian",
            comment)) {}
  void element(const char* name, std::size_t count) { bytes_ += fmt::format("element {} {}\n", name, count); }
  void properties(const char* type, std::initializer_list<const char*> names) {
    for (const char* name : names) bytes_ += fmt::format("property {} {}\n", type, name);
  }
  void end_header() { bytes_ += "end_header\n"; }

  template <typename T>
  requires std::is_arithmetic_v<T>
  void put(T value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    bytes_.append(raw.data(), raw.size());
  }
  void put(const Vec3f& v) {
    for (int i = 0; i < 3; ++i) put(v[i]);
  }
  void put(const Color8& color) {
    for (const std::uint8_t c : color) put(c);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

float mean_radius(const RecordMapEntry& record) { return std::sqrt(record.radius1 * record.radius2); }

float largest_curvature(const Vec3f& hessian) {
  const float middle = 0.5f * (hessian[0] + hessian[2]);
  return std::abs(middle) + std::hypot(0.5f * (hessian[0] - hessian[2]), hessian[1]);
}

/// Maps the logarithm of the mean radius, over the range that the records have.
std::vector<Color8> record_colors(std::span<const RecordMapEntry> records) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const RecordMapEntry& record : records) {
    const double log_radius = std::log(static_cast<double>(mean_radius(record)));
    if (!std::isfinite(log_radius)) continue;
    low = std::min(low, log_radius);
    high = std::max(high, log_radius);
  }
  const double range = high > low ? high - low : 1.0;
  std::vector<Color8> colors;
  colors.reserve(records.size());
  for (const RecordMapEntry& record : records) {
    const double position = (std::log(static_cast<double>(mean_radius(record))) - low) / range;
    colors.push_back(record.is_sh != 0 ? kShColor : map_color8(position));
  }
  return colors;
}

void put_record(PlyBuilder& ply, const RecordMapEntry& record, const Color8& color) {
  ply.put(record.position);
  ply.put(record.normal);
  ply.put(color);
  ply.put(largest_curvature(record.hessian));
  ply.put(mean_radius(record));
  ply.put(record.radius1);
  ply.put(record.radius2);
  ply.put(record.axis1);
  ply.put(record.axis2);
  ply.put(Vec3f(record.radiance.matrix()));
  ply.put(record.gradient[0]);
  ply.put(record.gradient[1]);
  ply.put(record.hessian);
  ply.put(record.is_sh);
  ply.put(record.region);
  ply.put(record.face);
}

void put_ellipse_vertices(PlyBuilder& ply, const RecordMapEntry& record, const Color8& color, int segments) {
  const auto put_vertex = [&](const Vec3f& position) {
    ply.put(position);
    ply.put(record.normal);
    ply.put(color);
    ply.put(mean_radius(record));
  };
  // Counter-clockwise when seen from the side of the normal, whichever way the axes turn.
  const bool right_handed = record.axis1.cross(record.axis2).dot(record.normal) >= 0.0f;
  const Vec3f side = (right_handed ? record.radius2 : -record.radius2) * record.axis2;
  put_vertex(record.position);
  for (int i = 0; i < segments; ++i) {
    const float angle = 2.0f * kPiF * static_cast<float>(i) / static_cast<float>(segments);
    put_vertex(record.position + std::cos(angle) * record.radius1 * record.axis1 + std::sin(angle) * side);
  }
}

void put_ellipse_faces(PlyBuilder& ply, std::uint32_t centre, int segments) {
  const auto count = static_cast<std::uint32_t>(segments);
  for (std::uint32_t i = 0; i < count; ++i) {
    ply.put(std::uint8_t{3});
    ply.put(centre);
    ply.put(centre + 1 + i);
    ply.put(centre + 1 + (i + 1) % count);
  }
}

}  // namespace

void write_record_map(const std::filesystem::path& path, std::span<const RecordMapEntry> records) {
  PlyBuilder ply("vrc cache records; quality: largest |eigenvalue| of the luminance Hessian");
  ply.element("vertex", records.size());
  ply.properties("float", {"x", "y", "z", "nx", "ny", "nz"});
  ply.properties("uchar", {"red", "green", "blue"});
  ply.properties("float", {"quality", "radius", "r1", "r2", "e1x", "e1y", "e1z", "e2x", "e2y", "e2z", "L_r",
                           "L_g", "L_b", "g1", "g2", "h11", "h12", "h22"});
  ply.properties("uchar", {"is_sh"});
  ply.properties("uint", {"region", "face"});
  ply.end_header();
  const std::vector<Color8> colors = record_colors(records);
  for (std::size_t i = 0; i < records.size(); ++i) put_record(ply, records[i], colors[i]);
  write_file_atomically(path, ply.bytes());
}

void write_record_ellipses(const std::filesystem::path& path, std::span<const RecordMapEntry> records,
                           int segments) {
  VRC_CHECK(segments >= 3, "{} segments", segments);
  const auto count = static_cast<std::size_t>(segments);
  VRC_CHECK(records.size() <= kInvalidIndex / (count + 1), "{} records", records.size());
  PlyBuilder ply("vrc valid regions of cache records; quality: mean radius");
  ply.element("vertex", records.size() * (count + 1));
  ply.properties("float", {"x", "y", "z", "nx", "ny", "nz"});
  ply.properties("uchar", {"red", "green", "blue"});
  ply.properties("float", {"quality"});
  ply.element("face", records.size() * count);
  ply.properties("list uchar uint", {"vertex_indices"});
  ply.end_header();
  const std::vector<Color8> colors = record_colors(records);
  for (std::size_t i = 0; i < records.size(); ++i) put_ellipse_vertices(ply, records[i], colors[i], segments);
  for (std::size_t i = 0; i < records.size(); ++i) {
    put_ellipse_faces(ply, static_cast<std::uint32_t>(i * (count + 1)), segments);
  }
  write_file_atomically(path, ply.bytes());
}

}  // namespace vrc
