// SPDX-License-Identifier: GPL-3.0-or-later
#include "curvature_values.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace vrc {

double value_of(const PrincipalCurvatures& curvature, CurvatureQuantity quantity) {
  const double k1 = curvature.k1, k2 = curvature.k2;
  switch (quantity) {
    case CurvatureQuantity::kMean:
      return 0.5 * (k1 + k2);
    case CurvatureQuantity::kK1:
      return k1;
    case CurvatureQuantity::kK2:
      return k2;
    case CurvatureQuantity::kGauss:
      return k1 * k2;
    case CurvatureQuantity::kMax:
      return std::max(std::abs(k1), std::abs(k2));
  }
  VRC_CHECK(false, "quantity {}", static_cast<int>(quantity));
}

std::vector<PrincipalCurvatures> principal_curvatures(const CurvatureField& field) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t count = field.mesh().sector_count();
  std::vector<PrincipalCurvatures> result(count);
  parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
    for (std::size_t s = block * kBlock; s < std::min(count, (block + 1) * kBlock); ++s) {
      result[s] = principal_curvatures(field.shape_operator(s), field.mesh().sector_normal(s));
    }
  });
  return result;
}

ValueSummary summarize(std::vector<double> values) {
  VRC_CHECK(!values.empty(), "no values");
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = [&](double share) { return values[static_cast<std::size_t>(std::lround(share * last))]; };
  return {values.front(), at(0.5), values.back(), {at(0.02), at(0.98)}};
}

ValueRange color_range(const ValueSummary& summary, CurvatureQuantity quantity, double size) {
  constexpr double kRounding = 1e-6;
  ValueRange range = summary.robust;
  if (is_signed(quantity)) {
    range.high = std::max(std::abs(range.low), std::abs(range.high));
    range.low = -range.high;
  }
  const double unit = quantity == CurvatureQuantity::kGauss ? 1.0 / (size * size) : 1.0 / size;
  const double half = std::max(unit, std::abs(range.low));
  if (range.high - range.low > kRounding * half) return range;
  return {range.low - half, range.low + half};
}

namespace {

double face_integral(const SurfaceMesh& mesh, std::span<const PrincipalCurvatures> sectors,
                     std::size_t face) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    sum += value_of(sectors[mesh.corner_sector(face, k)], CurvatureQuantity::kGauss);
  }
  return mesh.face_area(face) * sum / 3.0;
}

/// Faces that are connected over edges, one component after the other.
class ComponentWalk {
 public:
  ComponentWalk(const SurfaceMesh& mesh, std::span<const PrincipalCurvatures> sectors)
      : mesh_(mesh),
        sectors_(sectors),
        face_seen_(mesh.face_count(), 0),
        vertex_seen_(mesh.vertex_count(), 0),
        edge_seen_(mesh.edge_count(), 0) {}

  [[nodiscard]] bool seen(std::size_t face) const { return face_seen_[face] != 0; }

  [[nodiscard]] ComponentCurvature walk(std::uint32_t seed) {
    ComponentCurvature component;
    std::vector<std::uint32_t> queue{seed};
    face_seen_[seed] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const std::uint32_t face = queue[i];
      count(face, component);
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t next = mesh_.neighbour(face, k);
        if (next == kInvalidIndex || face_seen_[next] != 0) continue;
        face_seen_[next] = 1;
        queue.push_back(next);
      }
    }
    return component;
  }

 private:
  void count(std::uint32_t face, ComponentCurvature& component) {
    ++component.faces;
    ++component.euler_characteristic;
    component.gauss_integral += face_integral(mesh_, sectors_, face);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh_.triangle(face)[static_cast<std::size_t>(k)];
      const std::uint32_t edge = mesh_.edge(face, k);
      if (vertex_seen_[vertex] == 0) ++component.euler_characteristic;
      vertex_seen_[vertex] = 1;
      if (edge_seen_[edge] != 0) continue;
      edge_seen_[edge] = 1;
      --component.euler_characteristic;
      component.crease_edges += mesh_.crease(edge) != 0 ? 1 : 0;
      component.closed = component.closed && (mesh_.crease(edge) & kCreaseBoundary) == 0;
    }
  }

  const SurfaceMesh& mesh_;
  std::span<const PrincipalCurvatures> sectors_;
  std::vector<std::uint8_t> face_seen_, vertex_seen_, edge_seen_;
};

}  // namespace

std::vector<ComponentCurvature> integrate_components(const SurfaceMesh& mesh,
                                                     std::span<const PrincipalCurvatures> sectors) {
  ComponentWalk walk(mesh, sectors);
  std::vector<ComponentCurvature> components;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    if (!walk.seen(face)) components.push_back(walk.walk(face));
  }
  return components;
}

}  // namespace vrc
