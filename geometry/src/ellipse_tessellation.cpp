// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/ellipse_tessellation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace vrc {
namespace {

using Polygon = std::vector<Vec2>;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Polygon inscribed_polygon(const Vec2& radii, int segments) {
  Polygon polygon;
  for (int i = 0; i < segments; ++i) {
    const double angle = 2.0 * kPi * i / segments;
    polygon.emplace_back(radii.x() * std::cos(angle), radii.y() * std::sin(angle));
  }
  return polygon;
}

double twice_area(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    sum += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return sum;
}

/// A walked face in the plane.
class FlatFace {
 public:
  FlatFace(const SurfaceMesh& mesh, const WalkedFace& walked, const Vec3& normal)
      : corners_(walked.corners), positions_(mesh.positions(walked.face)) {
    area_ = cross(corners_[1] - corners_[0], corners_[2] - corners_[0]);
    side_ = area_ < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; ++k) {
      normals_[static_cast<std::size_t>(k)] = side_ * mesh.corner_normal(walked.face, k);
    }
    fallback_ = normal;
  }

  [[nodiscard]] bool degenerate() const { return !(std::abs(area_) > 0.0); }
  [[nodiscard]] const std::array<Vec2, 3>& corners() const { return corners_; }
  [[nodiscard]] double side() const { return side_; }

  /// Signed distance, times the edge's length, of `p` from edge k; positive inside.
  [[nodiscard]] double inside(std::size_t k, const Vec2& p) const {
    return side_ * cross(corners_[(k + 1) % 3] - corners_[k], p - corners_[k]);
  }
  [[nodiscard]] Vec3 barycentric(const Vec2& p) const {
    const double b1 = cross(p - corners_[0], corners_[2] - corners_[0]) / area_;
    const double b2 = cross(corners_[1] - corners_[0], p - corners_[0]) / area_;
    return {1.0 - b1 - b2, b1, b2};
  }
  [[nodiscard]] Vec3 position(const Vec3& b) const {
    return b[0] * positions_[0] + b[1] * positions_[1] + b[2] * positions_[2];
  }
  /// Shading normal; where it vanishes, the ellipse's.
  [[nodiscard]] Vec3 normal(const Vec3& b) const {
    const Vec3 sum = b[0] * normals_[0] + b[1] * normals_[1] + b[2] * normals_[2];
    return sum.norm() > 0.0 ? Vec3(sum.normalized()) : fallback_;
  }

 private:
  std::array<Vec2, 3> corners_;
  std::array<Vec3, 3> positions_, normals_;
  Vec3 fallback_;
  double area_ = 0.0, side_ = 1.0;
};

/// Whether a face lies inside the polygon with so many segments, by the ellipse that the polygon's
/// sides touch.
bool covered(const FlatFace& face, const Vec2& radii, int segments) {
  const double inner = std::cos(kPi / segments);
  return std::ranges::all_of(
      face.corners(), [&](const Vec2& p) { return p.cwiseQuotient(radii).squaredNorm() <= inner * inner; });
}

/// Sutherland-Hodgman: the polygon on the inner side of edge k.
void cut(const FlatFace& face, std::size_t k, const Polygon& polygon, Polygon& result) {
  result.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[(i + 1) % polygon.size()];
    const double da = face.inside(k, a), db = face.inside(k, b);
    if (da >= 0.0) result.push_back(a);
    if ((da < 0.0) != (db < 0.0) && da != 0.0 && db != 0.0) result.push_back(a + da / (da - db) * (b - a));
  }
}

/// The part [first, second] of the segment from a to b that lies inside; empty where first > second.
std::pair<double, double> inner_part(const FlatFace& face, const Vec2& a, const Vec2& b) {
  double low = 0.0, high = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double da = face.inside(k, a), db = face.inside(k, b);
    if (da < 0.0 && db < 0.0) return {1.0, 0.0};
    if (da < 0.0) low = std::max(low, da / (da - db));
    if (db < 0.0) high = std::min(high, da / (da - db));
  }
  return {low, high};
}

/// Calls visit(FlatFace, whether it lies inside the polygon) for every face that the ellipse reaches.
template <typename Visit>
void for_each_face(const SurfaceMesh& mesh, const SurfaceEllipse& ellipse,
                   const EllipseTessellationOptions& options, const Visit& visit) {
  VRC_CHECK(options.segments >= 3, "{} segments", options.segments);
  const Frame& frame = ellipse.frame;
  VRC_CHECK(frame.tangent.cross(frame.bitangent).dot(frame.normal) > 0.0, "a left-handed frame");
  SurfaceWalkOptions walk;
  walk.max_faces = options.max_faces;
  walk.measure_deviation = false;
  for (const WalkedFace& walked : walk_surface(mesh, ellipse, walk).faces) {
    const FlatFace face(mesh, walked, frame.normal);
    if (!face.degenerate()) visit(face, covered(face, ellipse.radii, options.segments));
  }
}

void append_fan(const FlatFace& face, const Polygon& polygon, double lift, EllipseTessellation& result) {
  const auto first = static_cast<std::uint32_t>(result.positions.size());
  for (const Vec2& p : polygon) {
    const Vec3 b = face.barycentric(p);
    const Vec3 normal = face.normal(b);
    result.positions.emplace_back(face.position(b) + lift * normal);
    result.normals.push_back(normal);
  }
  for (std::uint32_t i = 2; i < polygon.size(); ++i) {
    result.triangles.push_back({first, first + i - 1, first + i});
  }
}

}  // namespace

EllipseTessellation tessellate_ellipse(const SurfaceMesh& mesh, const SurfaceEllipse& ellipse,
                                       const EllipseTessellationOptions& options) {
  constexpr double kSmallestShare = 1e-12;  // of the ellipse, that a piece must cover
  const Polygon whole = inscribed_polygon(ellipse.radii, options.segments);
  const double smallest = kSmallestShare * twice_area(whole);
  EllipseTessellation result;
  Polygon piece, scratch;
  for_each_face(mesh, ellipse, options, [&](const FlatFace& face, bool inside) {
    if (inside) {
      piece.assign(face.corners().begin(), face.corners().end());
      if (face.side() < 0.0) std::swap(piece[1], piece[2]);
    } else {
      piece = whole;
      for (std::size_t k = 0; k < 3; ++k) {
        cut(face, k, piece, scratch);
        piece.swap(scratch);
      }
    }
    if (piece.size() >= 3 && twice_area(piece) > smallest) append_fan(face, piece, options.lift, result);
  });
  return result;
}

std::vector<OutlineSegment> ellipse_outline(const SurfaceMesh& mesh, const SurfaceEllipse& ellipse,
                                            const EllipseTessellationOptions& options) {
  const Polygon polygon = inscribed_polygon(ellipse.radii, options.segments);
  std::vector<OutlineSegment> result;
  for_each_face(mesh, ellipse, options, [&](const FlatFace& face, bool inside) {
    if (inside) return;
    const auto point = [&](const Vec2& p) -> Vec3 {
      const Vec3 b = face.barycentric(p);
      return face.position(b) + options.lift * face.normal(b);
    };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2& a = polygon[i];
      const Vec2& b = polygon[(i + 1) % polygon.size()];
      const auto [low, high] = inner_part(face, a, b);
      if (low < high) result.push_back({point(a + low * (b - a)), point(a + high * (b - a))});
    }
  });
  return result;
}

}  // namespace vrc
