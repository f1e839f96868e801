// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/triangulate.h"

#include <algorithm>
#include <limits>

namespace vrc {
namespace {

// Which way triples of points turn. Points nearer to a line than a small fraction of the polygon's
// extent count as lying on it, so that corners that were collinear before they were rounded still are.
class Turns {
 public:
  Turns(const std::vector<Vec2>& points, double relative_tolerance) {
    double extent = 0.0;
    double rounding = 0.0;
    for (const Vec2& p : points) {
      extent = std::max(extent, (p - points.front()).norm());
      rounding = std::max(rounding, std::numeric_limits<double>::epsilon() * p.cwiseAbs().maxCoeff());
    }
    tolerance_ = relative_tolerance * extent + 2.0 * rounding;
  }

  // Twice the signed area, or exactly 0 for a collinear triple.
  double orientation(const Vec2& a, const Vec2& b, const Vec2& c) const {
    const double det = (a.x() - c.x()) * (b.y() - c.y()) - (a.y() - c.y()) * (b.x() - c.x());
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    return det * det <= tolerance_ * tolerance_ * longest ? 0.0 : det;
  }

  bool in_closed_triangle(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) const {
    return orientation(a, b, p) >= 0.0 && orientation(b, c, p) >= 0.0 && orientation(c, a, p) >= 0.0;
  }

  bool cross_properly(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) const {
    return orientation(a, b, c) * orientation(a, b, d) < 0.0 &&
           orientation(c, d, a) * orientation(c, d, b) < 0.0;
  }

 private:
  double tolerance_ = 0.0;
};

// Files round to single precision. Where that is too coarse for the polygon, only the rounding of
// double precision is allowed for.
constexpr double kLooseTolerance = 1e-7;
constexpr double kTightTolerance = 1e-15;

// Drops the coordinate along which the normal is longest; the polygon becomes counter-clockwise.
std::vector<Vec2> project_to_dominant_plane(std::span<const Vec3> corners, const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  int u = (axis + 1) % 3;
  int v = (axis + 2) % 3;
  if (normal[axis] < 0.0) std::swap(u, v);
  std::vector<Vec2> points;
  points.reserve(corners.size());
  for (const Vec3& p : corners) points.emplace_back(p[u], p[v]);
  return points;
}

bool is_strictly_convex(const std::vector<Vec2>& points, const Turns& turns) {
  // Every turn is to the left, and the polygon turns round only once: its edges change from
  // pointing up to pointing down once.
  const std::size_t n = points.size();
  int direction_changes = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& a = points[i];
    const Vec2& b = points[(i + 1) % n];
    const Vec2& c = points[(i + 2) % n];
    if (turns.orientation(a, b, c) <= 0.0) return false;
    const bool first_up = b.y() > a.y() || (b.y() == a.y() && b.x() < a.x());
    const bool second_up = c.y() > b.y() || (c.y() == b.y() && c.x() < b.x());
    direction_changes += first_up != second_up ? 1 : 0;
  }
  return direction_changes <= 2;
}

std::vector<Triangle> fan(std::size_t n, std::uint32_t apex) {
  std::vector<Triangle> triangles;
  triangles.reserve(n - 2);
  const auto size = static_cast<std::uint32_t>(n);
  for (std::uint32_t i = 1; i + 1 < size; ++i) {
    triangles.push_back({apex, (apex + i) % size, (apex + i + 1) % size});
  }
  return triangles;
}

// The corners not yet cut off, as a ring, each with the shape of its ear.
class EarClipper {
 public:
  EarClipper(const std::vector<Vec2>& points, const Turns& turns)
      : points_(points), turns_(turns), ring_(points.size()) {
    const auto n = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < n; ++i) ring_[i] = {(i + n - 1) % n, (i + 1) % n, 0.0};
    for (std::uint32_t i = 0; i < n; ++i) ring_[i].quality = ear_quality(i);
  }

  std::vector<Triangle> clip() {
    std::vector<Triangle> triangles;
    std::uint32_t start = 0;
    for (std::size_t left = points_.size(); left > 3; --left) {
      std::uint32_t tip = best_ear(start);
      if (ring_[tip].quality <= 0.0) {  // what blocked an ear earlier may have been cut off since
        refresh_blocked(start);
        tip = best_ear(start);
      }
      const auto [before, after, quality] = ring_[tip];
      triangles.push_back({before, tip, after});
      ring_[before].next = after;
      ring_[after].previous = before;
      ring_[before].quality = ear_quality(before);
      ring_[after].quality = ear_quality(after);
      start = before;
    }
    triangles.push_back({ring_[start].previous, start, ring_[start].next});
    return triangles;
  }

 private:
  struct Corner {
    std::uint32_t previous;
    std::uint32_t next;
    double quality;
  };

  // What is no ear scores below every ear, and below collinear corners if it is reflex; so a
  // polygon that has no ear (it cuts itself) still loses one corner at a time.
  static constexpr double kBlocked = -2.0;
  static constexpr double kReflex = -4.0;

  std::uint32_t best_ear(std::uint32_t start) const {
    std::uint32_t best = start;
    for (std::uint32_t i = ring_[start].next; i != start; i = ring_[i].next) {
      if (ring_[i].quality > ring_[best].quality) best = i;
    }
    return best;
  }

  void refresh_blocked(std::uint32_t start) {
    std::uint32_t i = start;
    do {
      if (ring_[i].quality == kBlocked) ring_[i].quality = ear_quality(i);
      i = ring_[i].next;
    } while (i != start);
  }

  // Area over squared longest edge for an ear (positive), 0 for a collinear corner.
  double ear_quality(std::uint32_t tip) const {
    const Vec2& a = points_[ring_[tip].previous];
    const Vec2& b = points_[tip];
    const Vec2& c = points_[ring_[tip].next];
    const double area = turns_.orientation(a, b, c);
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    const double shape = longest > 0.0 ? area / longest : 0.0;
    if (area < 0.0) return kReflex + shape;
    // A collinear corner goes last among the harmless: cutting it off leaves a triangle without area.
    if (area == 0.0) return ((a - b).dot(c - b) > 0.0 || longest == 0.0) ? 0.0 : -1.0;
    return is_blocked(tip) ? kBlocked : shape;
  }

  bool is_blocked(std::uint32_t tip) const {
    const std::uint32_t previous = ring_[tip].previous;
    const std::uint32_t next = ring_[tip].next;
    const Vec2& a = points_[previous];
    const Vec2& b = points_[tip];
    const Vec2& c = points_[next];
    const Eigen::AlignedBox2d ear(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c));
    for (std::uint32_t i = ring_[next].next; i != previous; i = ring_[i].next) {
      const Vec2& p = points_[i];
      const Vec2& q = points_[ring_[i].next];
      if (!ear.intersects(Eigen::AlignedBox2d(p.cwiseMin(q), p.cwiseMax(q)))) continue;
      const bool shared_corner = p == a || p == b || p == c;  // another visit of the same point
      if (!shared_corner && turns_.in_closed_triangle(p, a, b, c)) return true;
      if (turns_.cross_properly(a, c, p, q)) return true;
    }
    return false;
  }

  const std::vector<Vec2>& points_;
  const Turns& turns_;
  std::vector<Corner> ring_;
};

bool all_counterclockwise(const std::vector<Vec2>& points, const std::vector<Triangle>& triangles) {
  return std::all_of(triangles.begin(), triangles.end(), [&points](const Triangle& t) {
    const Vec2 u = points[t[1]] - points[t[0]];
    const Vec2 v = points[t[2]] - points[t[0]];
    return u.x() * v.y() - u.y() * v.x() > 0.0;
  });
}

std::vector<Triangle> clip_ears(const std::vector<Vec2>& points, const Turns& loose) {
  std::vector<Triangle> triangles = EarClipper(points, loose).clip();
  if (all_counterclockwise(points, triangles)) return triangles;
  return EarClipper(points, Turns(points, kTightTolerance)).clip();
}

}  // namespace

Vec3 newell_normal(std::span<const Vec3> corners) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  }
  return sum;
}

std::vector<Triangle> triangulate_polygon(std::span<const Vec3> corners) {
  const std::size_t n = corners.size();
  if (n < 3) return {};
  const Vec3 normal = newell_normal(corners);
  if (!(normal.cwiseAbs().maxCoeff() > 0.0)) return {};
  if (n == 3) return {{0, 1, 2}};
  const std::vector<Vec2> points = project_to_dominant_plane(corners, normal);
  const Turns loose(points, kLooseTolerance);
  if (!is_strictly_convex(points, loose)) return clip_ears(points, loose);
  const bool first_diagonal =
      n != 4 || (corners[2] - corners[0]).squaredNorm() <= (corners[3] - corners[1]).squaredNorm();
  return fan(n, first_diagonal ? 0 : 1);
}

}  // namespace vrc
