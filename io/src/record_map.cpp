// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/record_map.h"

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/color.h"

namespace vrc {
namespace {

using Color8 = std::array<std::uint8_t, 3>;
constexpr Color8 kShColor{230, 94, 0};

bool holds_sh(const RecordMapEntry& record) { return record.harmonics_reason != HarmonicsReason::kNone; }

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
    colors.push_back(holds_sh(record) ? kShColor : map_color8(position));
  }
  return colors;
}

/// Collects arrays with a value for each record.
class RecordArrays {
 public:
  explicit RecordArrays(std::span<const RecordMapEntry> records) : records_(records) {}

  /// `get(record)` is a vector.
  template <typename Get>
  void vector(const std::string& name, std::vector<std::string> components, const Get& get) {
    std::vector<float> values;
    values.reserve(components.size() * records_.size());
    for (const RecordMapEntry& record : records_) {
      const auto& value = get(record);
      for (Eigen::Index i = 0; i < value.size(); ++i) values.push_back(value[i]);
    }
    arrays_.push_back({name, std::move(components), std::move(values)});
  }
  template <typename Get>
  void scalar(const std::string& name, const Get& get) {
    numbers<float>(name, get);
  }
  template <typename T, typename Get>
  void numbers(const std::string& name, const Get& get, std::vector<std::string> words = {}) {
    std::vector<T> values;
    values.reserve(records_.size());
    for (const RecordMapEntry& record : records_) values.push_back(static_cast<T>(get(record)));
    arrays_.push_back({name, {name}, std::move(values), std::move(words)});
  }
  void add(SurfaceArray array) { arrays_.push_back(std::move(array)); }
  [[nodiscard]] std::vector<SurfaceArray> take() { return std::move(arrays_); }

 private:
  std::span<const RecordMapEntry> records_;
  std::vector<SurfaceArray> arrays_;
};

void append(std::vector<std::uint8_t>& values, const Color8& color) {
  values.insert(values.end(), color.begin(), color.end());
}

SurfaceArray color_array(std::vector<std::uint8_t> values) {
  return {"color", {"red", "green", "blue"}, std::move(values)};
}

template <typename Reason>
std::vector<std::string> words_of(std::size_t count) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < count; ++i) words.emplace_back(name_of(static_cast<Reason>(i)));
  return words;
}

void add_radiance(RecordArrays& a) {
  a.vector("radiance", {"L_r", "L_g", "L_b"}, [](const auto& r) { return r.radiance; });
  a.scalar("L_stddev", [](const auto& r) { return r.luminance_deviation; });
  a.vector("gradient", {"g1", "g2"}, [](const auto& r) { return r.gradient; });
  a.vector("hessian", {"h11", "h12", "h22"}, [](const auto& r) { return r.hessian; });
  a.scalar("clamp_factor", [](const auto& r) { return r.clamp_factor; });
  a.scalar("nearest_hit", [](const auto& r) { return r.nearest_hit; });
  a.scalar("mean_hit", [](const auto& r) { return r.mean_hit; });
}

void add_curvature(RecordArrays& a) {
  a.scalar("deviation", [](const auto& r) { return r.curvature.deviation; });
  a.scalar("curvature", [](const auto& r) { return r.curvature.curvature; });
  a.scalar("relative_curvature", [](const auto& r) { return r.curvature.relative_curvature; });
  a.scalar("exponent", [](const auto& r) { return r.curvature.exponent; });
  a.numbers<std::uint8_t>(
      "reason", [](const auto& r) { return r.curvature.reason; },
      words_of<CurvatureReason>(kCurvatureReasons));
  a.numbers<std::uint8_t>("is_sh", holds_sh);
  a.numbers<std::uint8_t>(
      "sh_reason", [](const auto& r) { return r.harmonics_reason; },
      words_of<HarmonicsReason>(kHarmonicsReasons));
  a.numbers<std::uint8_t>("needs_sh", [](const auto& r) { return r.curvature.needs_sh(); });
}

/// kInvalidIndex becomes -1.
void add_place(RecordArrays& a) {
  a.numbers<std::int32_t>("region", [](const auto& r) { return r.region; });
  a.numbers<std::int32_t>("face", [](const auto& r) { return r.face; });
  a.numbers<std::int32_t>("patch", [](const auto& r) { return r.patch; });
  a.vector("uv", {"u", "v"}, [](const auto& r) { return r.uv; });
}

void add_picture(RecordArrays& a) {
  a.scalar("rays", [](const auto& r) { return r.rays; });
  a.vector("film", {"px", "py"}, [](const auto& r) { return r.film; });
  a.vector("film_axis1", {"p1x", "p1y"}, [](const auto& r) { return r.film_axis1; });
  a.vector("film_axis2", {"p2x", "p2y"}, [](const auto& r) { return r.film_axis2; });
}

}  // namespace

SurfaceExport record_map(std::span<const RecordMapEntry> records) {
  SurfaceExport points;
  points.comment = "vrc cache records; quality: largest |eigenvalue| of the luminance Hessian";
  for (const RecordMapEntry& record : records) points.positions.push_back(record.position);
  std::vector<std::uint8_t> colors;
  for (const Color8& color : record_colors(records)) append(colors, color);
  RecordArrays a(records);
  a.vector("Normals", {"nx", "ny", "nz"}, [](const auto& r) { return r.normal; });
  a.add(color_array(std::move(colors)));
  a.scalar("quality", [](const auto& r) { return largest_curvature(r.hessian); });
  a.scalar("radius", mean_radius);
  a.scalar("r1", [](const auto& r) { return r.radius1; });
  a.scalar("r2", [](const auto& r) { return r.radius2; });
  a.vector("e1", {"e1x", "e1y", "e1z"}, [](const auto& r) { return r.axis1; });
  a.vector("e2", {"e2x", "e2y", "e2z"}, [](const auto& r) { return r.axis2; });
  add_radiance(a);
  add_curvature(a);
  add_place(a);
  add_picture(a);
  points.vertex_arrays = a.take();
  return points;
}

SurfaceExport record_ellipses(std::span<const RecordMapEntry> records,
                              std::span<const EllipseTessellation> ellipses) {
  VRC_CHECK(records.size() == ellipses.size(), "{} ellipses of {} records", ellipses.size(), records.size());
  SurfaceExport surface;
  surface.comment = "vrc valid regions of cache records on the surface; quality: mean radius";
  std::vector<float> normals, quality;
  std::vector<std::uint8_t> colors, is_sh;
  std::vector<std::int32_t> numbers;
  const std::vector<Color8> by_size = record_colors(records);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const EllipseTessellation& ellipse = ellipses[i];
    const auto base = static_cast<std::uint32_t>(surface.positions.size());
    for (const auto& [a, b, c] : ellipse.triangles)
      surface.triangles.push_back({base + a, base + b, base + c});
    for (std::size_t v = 0; v < ellipse.positions.size(); ++v) {
      surface.positions.emplace_back(ellipse.positions[v].cast<float>());
      for (const double n : ellipse.normals[v]) normals.push_back(static_cast<float>(n));
      append(colors, by_size[i]);
      quality.push_back(mean_radius(records[i]));
      numbers.push_back(static_cast<std::int32_t>(i));
      is_sh.push_back(holds_sh(records[i]) ? 1 : 0);
    }
  }
  surface.vertex_arrays = {{"Normals", {"nx", "ny", "nz"}, std::move(normals)},
                           color_array(std::move(colors)),
                           {"quality", {"quality"}, std::move(quality)},
                           {"record", {"record"}, std::move(numbers)},
                           {"is_sh", {"is_sh"}, std::move(is_sh)}};
  return surface;
}

}  // namespace vrc
