// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_check.h"

#include <algorithm>
#include <cmath>

namespace vrc {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Segment {
  Vec2 a, b;
  double u_min, u_max;
};

std::vector<Segment> border(const ChartMesh& chart, std::span<const Vec2> uv) {
  std::vector<Segment> segments;
  for (std::size_t f = 0; f < chart.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (chart.neighbours[f][k] != kInvalidIndex) continue;
      const Vec2& a = uv[chart.triangles[f][k]];
      const Vec2& b = uv[chart.triangles[f][(k + 1) % 3]];
      segments.push_back({a, b, std::min(a.x(), b.x()), std::max(a.x(), b.x())});
    }
  }
  return segments;
}

// Each has its ends clearly on both sides of the other; touching, as at a slit, is none.
bool cross_each_other(const Segment& s, const Segment& t) {
  constexpr double kClear = 1e-7;  // Relative to the lengths.
  const auto separates = [](const Segment& line, const Segment& other) {
    const Vec2 d = line.b - line.a;
    const double tolerance = kClear * d.norm() * (d.norm() + (other.b - other.a).norm());
    const double at_a = cross(d, other.a - line.a);
    const double at_b = cross(d, other.b - line.a);
    return (at_a > tolerance && at_b < -tolerance) || (at_a < -tolerance && at_b > tolerance);
  };
  return separates(s, t) && separates(t, s);
}

bool crosses_itself(std::vector<Segment> segments) {
  std::sort(segments.begin(), segments.end(),
            [](const Segment& s, const Segment& t) { return s.u_min < t.u_min; });
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = i + 1; j < segments.size() && segments[j].u_min <= segments[i].u_max; ++j) {
      if (cross_each_other(segments[i], segments[j])) return true;
    }
  }
  return false;
}

// The triangles turn more than once round a vertex: on top of each other.
bool winds_twice(const ChartMesh& chart, std::span<const Vec2> uv) {
  std::vector<double> turn(uv.size(), 0.0);
  for (const Triangle& t : chart.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 a = uv[t[(k + 1) % 3]] - uv[t[k]];
      const Vec2 b = uv[t[(k + 2) % 3]] - uv[t[k]];
      turn[t[k]] += std::atan2(cross(a, b), a.dot(b));
    }
  }
  constexpr double kOnce = 2.0 * kPi + 1e-6;
  return std::any_of(turn.begin(), turn.end(), [](double angle) { return angle > kOnce; });
}

}  // namespace

std::array<Vec2, 3> laid_down(const std::array<Vec3, 3>& p) {
  std::size_t base = 0;
  double longest = -1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = (p[(k + 1) % 3] - p[k]).norm();
    if (length <= longest) continue;
    longest = length;
    base = k;
  }
  const Vec3 e = p[(base + 1) % 3] - p[base];
  const Vec3 d = p[(base + 2) % 3] - p[base];
  std::array<Vec2, 3> flat;
  flat[base] = Vec2::Zero();
  flat[(base + 1) % 3] = Vec2(longest, 0.0);
  flat[(base + 2) % 3] = Vec2(e.dot(d) / longest, e.cross(d).norm() / longest);
  return flat;
}

Vec2 singular_values_of_map(const std::array<Vec3, 3>& p, const std::array<Vec2, 3>& uv) {
  const std::array<Vec2, 3> q = laid_down(p);
  std::size_t base = 0;
  while (q[base] != Vec2::Zero()) ++base;
  const std::size_t next = (base + 1) % 3;
  const std::size_t top = (base + 2) % 3;
  // Columns: where the unit vectors along and across the longest edge go.
  const Vec2 along = (uv[next] - uv[base]) / q[next].x();
  const Vec2 across = (uv[top] - uv[base] - q[top].x() * along) / q[top].y();
  const double half_sum = 0.5 * std::hypot(along.x() + across.y(), along.y() - across.x());
  const double half_difference = 0.5 * std::hypot(along.x() - across.y(), along.y() + across.x());
  return {half_sum + half_difference, half_sum - half_difference};
}

ChartCheck check_chart(const ChartMesh& chart, std::span<const Vec2> uv, const PatchAtlasOptions& options) {
  ChartCheck check;
  for (std::uint32_t f = 0; f < chart.size(); ++f) {
    const auto& [a, b, c] = chart.triangles[f];
    const Vec2 s = singular_values_of_map(chart.corners(f), {uv[a], uv[b], uv[c]});
    const double area_ratio = s[0] * s[1];
    // Written so that NaN fails.
    const bool good = cross(uv[b] - uv[a], uv[c] - uv[a]) > 0.0 && s[0] <= options.max_stretch * s[1] &&
                      area_ratio <= options.max_area_distortion &&
                      area_ratio * options.max_area_distortion >= 1.0;
    if (good) {
      check.max_stretch = std::max(check.max_stretch, s[0] / s[1]);
    } else {
      check.bad_faces.push_back(f);
    }
  }
  if (check.bad_faces.empty()) check.overlaps = winds_twice(chart, uv) || crosses_itself(border(chart, uv));
  return check;
}

}  // namespace vrc
