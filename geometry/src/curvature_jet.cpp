// SPDX-License-Identifier: GPL-3.0-or-later
#include "curvature_jet.h"

#include <CGAL/Eigen_svd.h>
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Simple_cartesian.h>

#include "geometry/curvature.h"

namespace vrc {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using JetFitting = CGAL::Monge_via_jet_fitting<Kernel, Kernel, CGAL::Eigen_svd>;

template <typename CgalVector>
Vec3 to_vec3(const CgalVector& v) {
  return {v.x(), v.y(), v.z()};
}

std::size_t coefficient_count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
}

// The largest usable degree, or 0.
int usable_degree(std::size_t points, int degree) {
  while (degree >= 2 && 2 * points < 3 * coefficient_count(degree)) --degree;
  return degree >= 2 ? degree : 0;
}

}  // namespace

SectorNeighbourhoods::SectorNeighbourhoods(const SurfaceMesh& mesh)
    : mesh_(mesh), begin_(mesh.sector_count() + 2, 0), visited_by_(mesh.sector_count(), 0) {
  const auto corner_count = static_cast<std::uint32_t>(3 * mesh.face_count());
  const auto sector_of = [&mesh](std::uint32_t c) {
    return mesh.corner_sector(c / 3, static_cast<int>(c % 3));
  };
  for (std::uint32_t c = 0; c < corner_count; ++c) ++begin_[sector_of(c) + 2];
  for (std::size_t s = 2; s < begin_.size(); ++s) begin_[s] += begin_[s - 1];
  corners_.resize(corner_count);
  for (std::uint32_t c = 0; c < corner_count; ++c) corners_[begin_[sector_of(c) + 1]++] = c;
}

std::vector<Vec3> SectorNeighbourhoods::points(std::uint32_t sector, int rings) {
  const auto position_of = [this](std::uint32_t s) {
    const std::uint32_t corner = corners_[begin_[s]];
    return mesh_.position(mesh_.triangle(corner / 3)[corner % 3]);
  };
  ++query_;
  visited_by_[sector] = query_;
  std::vector<std::uint32_t> reached{sector};
  std::size_t ring_begin = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const std::size_t ring_end = reached.size();
    for (; ring_begin < ring_end; ++ring_begin) {
      const std::uint32_t s = reached[ring_begin];
      for (std::uint32_t i = begin_[s]; i < begin_[s + 1]; ++i) {
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t neighbour = mesh_.corner_sector(corners_[i] / 3, k);
          if (visited_by_[neighbour] == query_) continue;
          visited_by_[neighbour] = query_;
          reached.push_back(neighbour);
        }
      }
    }
  }
  std::vector<Vec3> points;
  points.reserve(reached.size());
  for (const std::uint32_t s : reached) points.push_back(position_of(s));
  return points;
}

std::optional<Mat3> fit_jet(std::span<const Vec3> points, const Vec3& normal, int degree) {
  const int usable = usable_degree(points.size(), degree);
  if (usable == 0) return std::nullopt;
  std::vector<Kernel::Point_3> cloud;
  cloud.reserve(points.size());
  for (const Vec3& p : points) {
    const Vec3 local = p - points[0];
    cloud.emplace_back(local.x(), local.y(), local.z());
  }
  JetFitting fitting;
  auto monge = fitting(cloud.begin(), cloud.end(), static_cast<std::size_t>(usable), 2);
  constexpr double kWorstCondition = 1e8;
  if (!(fitting.condition_number() < kWorstCondition)) return std::nullopt;
  monge.comply_wrt_given_normal({normal.x(), normal.y(), normal.z()});
  const Vec3 fitted_normal = to_vec3(monge.normal_direction()).normalized();
  constexpr double kSameSide = 0.5;
  if (!(fitted_normal.dot(normal) > kSameSide)) return std::nullopt;

  // Monge's form z = (k1 x^2 + k2 y^2) / 2 rises along the normal, where our S is negative.
  const Vec3 d1 = to_vec3(monge.maximal_principal_direction());
  const Vec3 d2 = to_vec3(monge.minimal_principal_direction());
  const Mat3 s = -(monge.principal_curvatures(0) * d1 * d1.transpose() +
                   monge.principal_curvatures(1) * d2 * d2.transpose());
  const Mat3 turn = minimal_rotation(fitted_normal, normal);
  const Mat3 tensor = turn * s * turn.transpose();
  if (!tensor.allFinite()) return std::nullopt;
  return tensor;
}

}  // namespace vrc
