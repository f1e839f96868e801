// SPDX-License-Identifier: GPL-3.0-or-later
#include "polygon_cleanup.h"

#include <algorithm>
#include <bit>

#include "weld.h"

namespace vrc {
namespace {

// Rounding leaves a triangle with collinear corners an area of about 1e-16 of its squared longest
// edge; anything below this bound has no usable normal.
constexpr double kDegenerateShape = 1e-13;

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() > kDegenerateShape * longest;
}

// Finds polygons that visit the same vertices in the same cyclic order, either way round.
class DuplicateFinder {
 public:
  explicit DuplicateFinder(std::size_t polygons, std::size_t corners)
      : heads_(std::bit_ceil(2 * polygons + 1), kInvalidIndex) {
    begin_.reserve(polygons + 1);
    begin_.push_back(0);
    next_.reserve(polygons);
    vertices_.reserve(corners);
  }

  // False when the polygon was added before.
  bool add(std::span<const std::uint32_t> polygon) {
    std::uint32_t& head = heads_[hash(polygon) & (heads_.size() - 1)];
    for (std::uint32_t i = head; i != kInvalidIndex; i = next_[i]) {
      if (same_cycle(polygon, std::span(vertices_).subspan(begin_[i], begin_[i + 1] - begin_[i])))
        return false;
    }
    next_.push_back(head);
    head = static_cast<std::uint32_t>(begin_.size() - 1);
    vertices_.insert(vertices_.end(), polygon.begin(), polygon.end());
    begin_.push_back(vertices_.size());
    return true;
  }

 private:
  // Independent of where the polygon begins and of its direction.
  static std::uint64_t hash(std::span<const std::uint32_t> polygon) {
    std::uint64_t sum = 0;
    for (const std::uint32_t v : polygon) {
      const std::uint64_t h = (v + 1ULL) * 0x9e3779b97f4a7c15ULL;
      sum += (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9ULL;
    }
    return sum ^ (sum >> 32);
  }

  static bool same_cycle(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
    const std::size_t n = a.size();
    if (n != b.size()) return false;
    for (std::size_t start = 0; start < n; ++start) {
      if (b[start] != a[0]) continue;
      bool forward = true;
      bool backward = true;
      for (std::size_t i = 1; i < n && (forward || backward); ++i) {
        forward = forward && a[i] == b[(start + i) % n];
        backward = backward && a[i] == b[(start + n - i) % n];
      }
      if (forward || backward) return true;
    }
    return false;
  }

  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> vertices_;
};

// One polygon's corners without immediate repetitions of a vertex.
struct Polygon {
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> corners;  ///< Into the soup's corner arrays.
};

void load_polygon(const PolygonSoup& soup, const std::vector<std::uint32_t>& vertex_of, std::size_t face,
                  Polygon& polygon) {
  polygon.vertices.clear();
  polygon.corners.clear();
  for (std::uint32_t c = soup.face_begin[face]; c < soup.face_begin[face + 1]; ++c) {
    const std::uint32_t v = vertex_of[soup.corner_position[c]];
    if (!polygon.vertices.empty() && polygon.vertices.back() == v) continue;
    polygon.vertices.push_back(v);
    polygon.corners.push_back(c);
  }
  while (polygon.vertices.size() > 1 && polygon.vertices.back() == polygon.vertices.front()) {
    polygon.vertices.pop_back();
    polygon.corners.pop_back();
  }
}

// Appends the polygon's triangles that have an area; returns how many pieces had none.
std::size_t append_triangles(const Polygon& polygon, std::uint32_t face, RepairedMesh& mesh) {
  std::vector<Vec3> points;
  points.reserve(polygon.vertices.size());
  for (const std::uint32_t v : polygon.vertices) points.push_back(mesh.positions[v]);
  const std::vector<Triangle> pieces = triangulate_polygon(points);
  std::size_t degenerate = pieces.empty() ? 1 : 0;
  for (const auto& [a, b, c] : pieces) {
    if (!has_area(points[a], points[b], points[c])) {
      ++degenerate;
      continue;
    }
    mesh.triangles.push_back({polygon.vertices[a], polygon.vertices[b], polygon.vertices[c]});
    mesh.source_polygon.push_back(face);
    mesh.source_corner.insert(mesh.source_corner.end(),
                              {polygon.corners[a], polygon.corners[b], polygon.corners[c]});
  }
  return degenerate;
}

}  // namespace

RepairedMesh clean_polygons(const PolygonSoup& soup, double weld_tolerance) {
  RepairedMesh mesh;
  const std::size_t polygons = soup.face_count();
  const double diagonal = soup.positions.empty() ? 0.0 : soup.bounds().diagonal().norm();
  WeldedPositions welded = weld_positions(soup.positions, weld_tolerance * diagonal);
  mesh.positions = std::move(welded.positions);
  mesh.report.welded_vertices = soup.positions.size() - mesh.positions.size();

  mesh.triangles.reserve(soup.corner_position.size() - std::min(2 * polygons, soup.corner_position.size()));
  mesh.source_polygon.reserve(mesh.triangles.capacity());
  mesh.source_corner.reserve(3 * mesh.triangles.capacity());
  DuplicateFinder duplicates(polygons, soup.corner_position.size());
  Polygon polygon;
  for (std::size_t face = 0; face < polygons; ++face) {
    load_polygon(soup, welded.vertex_of, face, polygon);
    if (polygon.vertices.size() < 3) {
      ++mesh.report.degenerate_faces;
      continue;
    }
    if (!duplicates.add(polygon.vertices)) {
      ++mesh.report.duplicate_faces;
      continue;
    }
    mesh.report.triangulated_polygons += polygon.vertices.size() > 3 ? 1 : 0;
    mesh.report.degenerate_faces += append_triangles(polygon, static_cast<std::uint32_t>(face), mesh);
  }
  mesh.flipped.assign(mesh.triangles.size(), 0);
  mesh.detached_edge.assign(3 * mesh.triangles.size(), 0);
  return mesh;
}

}  // namespace vrc
