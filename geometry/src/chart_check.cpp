// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vrc {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Segment {
  Vec2 a, b;  // The face is on the left.
  double u_min, u_max;
  Vec2 inside;  // Of the face, close to the middle of the segment.
};

std::vector<Segment> border(const ChartMesh& chart, std::span<const Vec2> uv) {
  std::vector<Segment> segments;
  for (std::size_t f = 0; f < chart.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (chart.neighbours[f][k] != kInvalidIndex) continue;
      const Vec2& a = uv[chart.triangles[f][k]];
      const Vec2& b = uv[chart.triangles[f][(k + 1) % 3]];
      const Vec2& c = uv[chart.triangles[f][(k + 2) % 3]];
      constexpr double kInset = 1e-3;
      segments.push_back({a, b, std::min(a.x(), b.x()), std::max(a.x(), b.x()),
                          0.5 * (1.0 - kInset) * (a + b) + kInset * c});
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

// Signed crossings of the ray from the point towards +v.
int crossing(const Segment& s, const Vec2& point) {
  const bool from = s.a.x() > point.x();
  const bool to = s.b.x() > point.x();
  if (from == to) return 0;
  // Above the point, a border that has the map below it runs to the left.
  const bool above = (cross(s.b - s.a, point - s.a) > 0.0) == from;
  return !above ? 0 : from ? 1 : -1;
}

// Sheets may lie on each other with borders that only touch, as those of a spiral ramp seen from above.
// How many cover a point is the winding number of the border around it, which changes at the border
// only; so it is enough to look beside each segment of it.
bool covers_twice(const std::vector<Segment>& segments) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double width = 0.0;
  for (const Segment& s : segments) {
    low = std::min(low, s.u_min);
    high = std::max(high, s.u_max);
    width += s.u_max - s.u_min;
  }
  // Per strip of u the segments that meet it: about four strips a segment.
  const auto count = static_cast<double>(segments.size());
  const auto strips =
      static_cast<std::size_t>(std::clamp(4.0 * count * (high - low) / width, 1.0, 1.0 + count));
  const auto strip = [&](double u) {
    const double position = (u - low) / (high - low) * static_cast<double>(strips);
    return std::min(static_cast<std::size_t>(std::max(position, 0.0)), strips - 1);
  };
  std::vector<std::vector<std::uint32_t>> members(strips);
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = strip(segments[i].u_min); j <= strip(segments[i].u_max); ++j)
      members[j].push_back(i);
  }
  return std::any_of(segments.begin(), segments.end(), [&](const Segment& s) {
    int winding = 0;
    for (const std::uint32_t i : members[strip(s.inside.x())]) winding += crossing(segments[i], s.inside);
    return winding > 1;
  });
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
  if (check.bad_faces.empty()) {
    const std::vector<Segment> segments = border(chart, uv);
    check.overlaps = winds_twice(chart, uv) || covers_twice(segments) || crosses_itself(segments);
  }
  return check;
}

}  // namespace vrc
