// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_walker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <queue>

#include "core/error.h"
#include "core/hash.h"
#include "geometry/curvature.h"

namespace vrc {
namespace {

constexpr std::size_t next(std::size_t k) { return k == 2 ? 0 : k + 1; }

// Open addressing; most walks reach a few faces of a mesh that may have millions.
class FaceSet {
 public:
  // False when the face was in the set.
  bool insert(std::uint32_t face) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    std::uint32_t& slot = find(face);
    if (slot == face) return false;
    slot = face;
    ++count_;
    return true;
  }
  [[nodiscard]] bool contains(std::uint32_t face) { return find(face) == face; }

 private:
  std::uint32_t& find(std::uint32_t face) {
    std::size_t i = mix(face) & (slots_.size() - 1);
    while (slots_[i] != kInvalidIndex && slots_[i] != face) i = (i + 1) & (slots_.size() - 1);
    return slots_[i];
  }
  void grow() {
    std::vector<std::uint32_t> old(2 * slots_.size(), kInvalidIndex);
    old.swap(slots_);
    for (const std::uint32_t face : old) {
      if (face != kInvalidIndex) find(face) = face;
    }
  }

  std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(64, kInvalidIndex);
  std::size_t count_ = 0;
};

// Smallest squared distance of the segment from the origin.
double squared_distance(const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp(-a.dot(d) / length2, 0.0, 1.0) : 0.0;
  return (a + t * d).squaredNorm();
}

// An edge of a walked face that meets the ellipse, to be crossed.
struct Gate {
  double distance2;     // From the centre, in units of the radii.
  std::uint32_t order;  // Decides between equal distances.
  std::uint32_t face;   // Behind the edge.
  std::uint32_t entry;  // The edge's corner k in `face`.
  Vec2 begin, end;      // Where corners k and k + 1 of `face` are in the plane.
  // For a queue whose top is the nearest gate.
  bool operator<(const Gate& other) const {
    return distance2 != other.distance2 ? distance2 > other.distance2 : order > other.order;
  }
};

// One walk: the faces it has taken and the gates it has yet to pass.
class Walk {
 public:
  Walk(const SurfaceMesh& mesh, const SurfaceEllipse& ellipse, const SurfaceWalkOptions& options)
      : mesh_(mesh), ellipse_(ellipse), options_(options), inverse_radii_(ellipse.radii.cwiseInverse()) {}

  SurfaceWalk run() {
    const std::size_t max_faces = std::max<std::size_t>(1, options_.max_faces);
    take_first();
    while (!gates_.empty()) {
      const Gate gate = gates_.top();
      gates_.pop();
      if (reached_.contains(gate.face)) continue;
      if (turned_away(gate.face)) {
        reached_.insert(gate.face);
        continue;
      }
      if (walk_.faces.size() == max_faces) {
        walk_.truncated = true;
        break;
      }
      take(gate.face, unfold(gate));
    }
    return std::move(walk_);
  }

 private:
  void take_first() {
    const std::array<Vec3, 3> p = mesh_.positions(ellipse_.face);
    const Vec3& b = ellipse_.barycentric;
    const Vec3 center = b[0] * p[0] + b[1] * p[1] + b[2] * p[2];
    const Vec3 normal = mesh_.face_normal(ellipse_.face);
    side_ = normal.dot(ellipse_.frame.normal) < 0.0 ? -1.0 : 1.0;
    const Mat3 turn = minimal_rotation(side_ * normal, ellipse_.frame.normal);
    std::array<Vec2, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 d = turn * (p[k] - center);
      corners[k] = Vec2(d.dot(ellipse_.frame.tangent), d.dot(ellipse_.frame.bitangent));
    }
    take(ellipse_.face, corners);
  }

  // The third corner keeps its distances to the ends of the edge, on the far side of it.
  std::array<Vec2, 3> unfold(const Gate& gate) const {
    const std::array<Vec3, 3> p = mesh_.positions(gate.face);
    const std::size_t k = gate.entry;
    const Vec3 e = p[next(k)] - p[k];
    const Vec3 d = p[next(next(k))] - p[k];
    const double length2 = e.squaredNorm();
    const double along = e.dot(d) / length2;
    const double across = side_ * e.cross(d).norm() / length2;
    const Vec2 flat = gate.end - gate.begin;
    std::array<Vec2, 3> corners;
    corners[k] = gate.begin;
    corners[next(k)] = gate.end;
    corners[next(next(k))] = gate.begin + along * flat + across * Vec2(-flat.y(), flat.x());
    return corners;
  }

  void take(std::uint32_t face, const std::array<Vec2, 3>& corners) {
    reached_.insert(face);
    WalkedFace walked{face, corners, options_.measure_deviation ? deviation(face, corners) : 0.0};
    walk_.normal_deviation = std::max(walk_.normal_deviation, walked.normal_deviation);
    walk_.faces.push_back(walked);
    for (std::size_t k = 0; k < 3; ++k) add_gate(face, k, corners[k], corners[next(k)]);
  }

  void add_gate(std::uint32_t face, std::size_t k, const Vec2& a, const Vec2& b) {
    const double distance2 = squared_distance(a.cwiseProduct(inverse_radii_), b.cwiseProduct(inverse_radii_));
    if (!(distance2 <= 1.0)) return;
    const HalfedgeMesh& halfedges = mesh_.mesh();
    const OpenMesh::HalfedgeHandle across =
        halfedges.opposite_halfedge_handle(face_halfedge(halfedges, face, static_cast<int>(k)));
    const auto edge = static_cast<std::size_t>(halfedges.edge_handle(across).idx());
    if (halfedges.is_boundary(across) || mesh_.crease(edge) != 0) return;
    const auto behind = static_cast<std::uint32_t>(halfedges.face_handle(across).idx());
    if (reached_.contains(behind)) return;
    const auto entry = static_cast<std::uint32_t>(halfedge_corner(halfedges, across));
    gates_.push({distance2, gate_count_++, behind, entry, b, a});
  }

  // Whether no normal of the face can lie within the accepted deviation: the normals of its points lie
  // in the cone around the mean normal that holds its corners'.
  [[nodiscard]] bool turned_away(std::uint32_t face) const {
    if (!(options_.max_deviation < kPi)) return false;
    std::array<Vec3, 3> normals;
    Vec3 mean = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      normals[k] = side_ * mesh_.corner_normal(face, static_cast<int>(k));
      mean += normals[k];
    }
    const double length = mean.norm();
    if (!(length > 0.0)) return false;
    mean /= length;
    double spread = 1.0;
    for (const Vec3& n : normals) spread = std::min(spread, n.dot(mean));
    const double least = std::acos(std::clamp(mean.dot(ellipse_.frame.normal), -1.0, 1.0)) -
                         std::acos(std::clamp(spread, -1.0, 1.0));
    return least > options_.max_deviation;
  }

  // The largest over the corners of the part inside the ellipse: the face's own corners, the ends of
  // the chords that its edges cut off, and some points of the ellipse.
  double deviation(std::uint32_t face, const std::array<Vec2, 3>& corners) const {
    std::array<Vec3, 3> normals;
    for (int k = 0; k < 3; ++k) normals[static_cast<std::size_t>(k)] = side_ * mesh_.corner_normal(face, k);
    double smallest = 1.0;
    const auto visit = [&](const Vec3& normal) {
      const double length = normal.norm();
      if (length > 0.0) smallest = std::min(smallest, normal.dot(ellipse_.frame.normal) / length);
    };
    std::array<Vec2, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = corners[k].cwiseProduct(inverse_radii_);
    for (std::size_t k = 0; k < 3; ++k) {
      if (p[k].squaredNorm() <= 1.0) visit(normals[k]);
      const Vec2 d = p[next(k)] - p[k];
      // |p + t d| = 1
      const double a = d.squaredNorm();
      const double half_b = p[k].dot(d);
      const double discriminant = half_b * half_b - a * (p[k].squaredNorm() - 1.0);
      if (!(a > 0.0) || discriminant < 0.0) continue;
      for (const double root : {-std::sqrt(discriminant), std::sqrt(discriminant)}) {
        const double t = (root - half_b) / a;
        if (t >= 0.0 && t <= 1.0) visit((1.0 - t) * normals[k] + t * normals[next(k)]);
      }
    }
    visit_rim(p, normals, visit);
    return std::acos(std::clamp(smallest, -1.0, 1.0));
  }

  template <typename Visit>
  static void visit_rim(const std::array<Vec2, 3>& p, const std::array<Vec3, 3>& normals,
                        const Visit& visit) {
    const Vec2 d1 = p[1] - p[0];
    const Vec2 d2 = p[2] - p[0];
    const double area = d1.x() * d2.y() - d1.y() * d2.x();
    constexpr double kDiagonal = 0.70710678118654752;
    static const std::array<Vec2, 8> rim{
        Vec2(1, 0),  Vec2(kDiagonal, kDiagonal),   Vec2(0, 1),  Vec2(-kDiagonal, kDiagonal),
        Vec2(-1, 0), Vec2(-kDiagonal, -kDiagonal), Vec2(0, -1), Vec2(kDiagonal, -kDiagonal)};
    for (const Vec2& point : rim) {
      const Vec2 d = point - p[0];
      const double b1 = (d.x() * d2.y() - d.y() * d2.x()) / area;
      const double b2 = (d1.x() * d.y() - d1.y() * d.x()) / area;
      if (!(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0)) continue;
      visit((1.0 - b1 - b2) * normals[0] + b1 * normals[1] + b2 * normals[2]);
    }
  }

  const SurfaceMesh& mesh_;
  const SurfaceEllipse& ellipse_;
  const SurfaceWalkOptions& options_;
  const Vec2 inverse_radii_;
  double side_ = 1.0;
  std::priority_queue<Gate> gates_;
  std::uint32_t gate_count_ = 0;
  FaceSet reached_;
  SurfaceWalk walk_;
};

}  // namespace

SurfaceWalk walk_surface(const SurfaceMesh& mesh, const SurfaceEllipse& ellipse,
                         const SurfaceWalkOptions& options) {
  VRC_CHECK(ellipse.face < mesh.face_count(), "face {} of {}", ellipse.face, mesh.face_count());
  VRC_CHECK(ellipse.radii.minCoeff() > 0.0 && ellipse.radii.allFinite(), "radii {} and {}", ellipse.radii.x(),
            ellipse.radii.y());
  return Walk(mesh, ellipse, options).run();
}

SurfaceEllipse make_ellipse(const SurfaceMesh& mesh, std::uint32_t face, const Vec3& barycentric,
                            const Vec3& tangent, const Vec2& radii) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) sum += barycentric[k] * mesh.corner_normal(face, k);
  const Vec3 normal = sum.norm() > 0.0 ? Vec3(sum.normalized()) : mesh.face_normal(face);
  const Vec3 projected = tangent - normal.dot(tangent) * normal;
  VRC_CHECK(projected.norm() > 0.0, "the tangent is parallel to the normal");
  const Vec3 axis = projected.normalized();
  return {face, barycentric, {axis, normal.cross(axis), normal}, radii};
}

bool meets_ellipse(const Vec2& a, const Vec2& b, const Vec2& radii) {
  return squared_distance(a.cwiseQuotient(radii), b.cwiseQuotient(radii)) <= 1.0;
}

}  // namespace vrc
