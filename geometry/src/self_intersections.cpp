// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

namespace vrc {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;
using FacePair = std::pair<std::uint32_t, std::uint32_t>;

/// Per vertex the smallest vertex at the same position.
std::vector<std::uint32_t> merge_equal_positions(const SurfaceMesh& mesh) {
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 p = mesh.position(a), q = mesh.position(b);
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::vector<std::uint32_t> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), before);
  std::vector<std::uint32_t> merged(order.size());
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || before(first, order[i])) first = order[i];
    merged[order[i]] = first;
  }
  return merged;
}

/// A face with its corners turned so that those which it shares with another face come first.
struct Corners {
  std::array<std::uint32_t, 3> vertex;
  std::array<Point, 3> point;
};

/// How many corners `a` and `b` share; these come first in both, in the same order.
int align_shared(Corners& a, Corners& b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = shared; k < 3; ++k) {
      if (a.vertex[i] != b.vertex[k]) continue;
      std::swap(a.vertex[i], a.vertex[shared]);
      std::swap(a.point[i], a.point[shared]);
      std::swap(b.vertex[k], b.vertex[shared]);
      std::swap(b.point[k], b.point[shared]);
      ++shared;
      break;
    }
  }
  return shared;
}

bool meet_elsewhere(Corners a, Corners b) {
  const Kernel::Do_intersect_3 intersect{};
  const auto triangle = [](const Corners& c) {
    return Kernel::Triangle_3(c.point[0], c.point[1], c.point[2]);
  };
  const auto far_edge = [](const Corners& c) { return Kernel::Segment_3(c.point[1], c.point[2]); };
  switch (align_shared(a, b)) {
    case 0:
      return intersect(triangle(a), triangle(b));
    case 1:
      return intersect(triangle(a), far_edge(b)) || intersect(triangle(b), far_edge(a));
    case 2:  // beyond the common edge only where one lies folded onto the other
      return CGAL::coplanar(a.point[0], a.point[1], a.point[2], b.point[2]) &&
             CGAL::coplanar_orientation(a.point[0], a.point[1], a.point[2], b.point[2]) == CGAL::POSITIVE;
    default:
      return true;
  }
}

class FaceTable {
 public:
  explicit FaceTable(const SurfaceMesh& mesh) : mesh_(mesh), merged_(merge_equal_positions(mesh)) {}

  [[nodiscard]] Corners corners(std::uint32_t face) const {
    const auto position = mesh_.positions(face);
    Corners result;
    for (std::size_t k = 0; k < 3; ++k) {
      result.vertex[k] = merged_[mesh_.triangle(face)[k]];
      result.point[k] = Point(position[k].x(), position[k].y(), position[k].z());
    }
    return result;
  }

 private:
  const SurfaceMesh& mesh_;
  std::vector<std::uint32_t> merged_;
};

}  // namespace

SelfIntersections find_self_intersections(const SurfaceMesh& mesh, std::size_t pairs_kept) {
  const FaceTable faces(mesh);
  std::vector<Box> boxes;
  boxes.reserve(mesh.face_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto [p, q, r] = faces.corners(f).point;
    if (!CGAL::collinear(p, q, r)) boxes.emplace_back(p.bbox() + q.bbox() + r.bbox(), f);
  }
  SelfIntersections result;
  std::set<FacePair> first;  // bounded, as all pairs may be more than memory holds
  const auto test = [&](const Box& a, const Box& b) {
    if (!meet_elsewhere(faces.corners(a.info()), faces.corners(b.info()))) return;
    ++result.pair_count;
    first.insert(std::minmax({a.info(), b.info()}));
    if (first.size() > pairs_kept) first.erase(std::prev(first.end()));
  };
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), test);
  result.first_pairs.assign(first.begin(), first.end());
  return result;
}

}  // namespace vrc
