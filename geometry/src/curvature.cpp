// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/curvature.h"

#include <Eigen/QR>
#include <cmath>

#include "core/error.h"
#include "core/frame.h"
#include "curvature_jet.h"

namespace vrc {
namespace {

using Tensor = CurvatureField::Tensor;
using TangentBasis = Eigen::Matrix<double, 3, 2>;

TangentBasis tangent_basis(const Vec3& normal) {
  const Frame frame = Frame::around(normal);
  TangentBasis basis;
  basis << frame.tangent, frame.bitangent;
  return basis;
}

Mat2 to_matrix(const Tensor& t) { return (Mat2() << t[0], t[1], t[1], t[2]).finished(); }
Tensor to_tensor(const Mat2& m) { return {m(0, 0), 0.5 * (m(0, 1) + m(1, 0)), m(1, 1)}; }

// A tensor of one tangent plane seen from another.
Mat2 transported(const Mat2& s, const Vec3& from, const Vec3& to) {
  const Mat2 turn = tangent_basis(to).transpose() * minimal_rotation(from, to) * tangent_basis(from);
  return turn * s * turn.transpose();
}

// The symmetric S that best explains, along the three edges, how the corner normals differ:
// S (e . u, e . v) = (dn . u, dn . v). [Rusinkiewicz2004]
// QR, because the normal equations square the condition of a sliver.
Mat2 face_tensor(const SurfaceMesh& mesh, std::size_t face, const Vec3& normal) {
  const std::array<Vec3, 3> p = mesh.positions(face);
  const TangentBasis frame = tangent_basis(normal);
  Eigen::Matrix<double, 6, 3> lhs;
  Eigen::Matrix<double, 6, 1> rhs;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vec2 e = frame.transpose() * (p[static_cast<std::size_t>(next)] - p[static_cast<std::size_t>(k)]);
    const Vec2 dn = frame.transpose() * (mesh.corner_normal(face, next) - mesh.corner_normal(face, k));
    lhs.row(2 * k) << e.x(), e.y(), 0.0;
    lhs.row(2 * k + 1) << 0.0, e.x(), e.y();
    rhs.segment<2>(2 * k) = dn;
  }
  const Eigen::Vector3d s = lhs.householderQr().solve(rhs);
  return (Mat2() << s[0], s[1], s[1], s[2]).finished();
}

// How the area of a triangle is shared out among its corners: Voronoi regions, or halves and quarters
// where a right or obtuse angle would push them outside. [Meyer2003]
std::array<double, 3> corner_areas(const std::array<Vec3, 3>& p) {
  const double area = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
  std::array<double, 3> cot_times_opposite{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 u = p[(k + 1) % 3] - p[k];
    const Vec3 v = p[(k + 2) % 3] - p[k];
    if (u.dot(v) <= 0.0) {
      std::array<double, 3> shares{};
      for (std::size_t j = 0; j < 3; ++j) shares[j] = area * (j == k ? 0.5 : 0.25);
      return shares;
    }
    cot_times_opposite[k] = 0.5 * u.dot(v) / area * (u - v).squaredNorm();
  }
  std::array<double, 3> shares{};
  for (std::size_t k = 0; k < 3; ++k) {
    shares[k] = 0.125 * (cot_times_opposite[(k + 1) % 3] + cot_times_opposite[(k + 2) % 3]);
  }
  return shares;
}

// Area-weighted means over the faces of each sector of `tensor_of(face, face normal)`, which is given
// in the frame of the face.
template <typename FaceTensor>
std::vector<Tensor> gather_at_sectors(const SurfaceMesh& mesh, const FaceTensor& tensor_of) {
  std::vector<Mat2> sums(mesh.sector_count(), Mat2::Zero());
  std::vector<double> weights(mesh.sector_count(), 0.0);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Vec3 normal = mesh.face_normal(f);
    const Mat2 tensor = tensor_of(f, normal);
    const std::array<double, 3> areas = corner_areas(mesh.positions(f));
    for (int k = 0; k < 3; ++k) {
      const double area = areas[static_cast<std::size_t>(k)];
      const std::uint32_t sector = mesh.corner_sector(f, k);
      sums[sector] += area * transported(tensor, normal, mesh.corner_normal(f, k));
      weights[sector] += area;
    }
  }
  std::vector<Tensor> tensors(sums.size(), Tensor{});
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (weights[s] > 0.0) tensors[s] = to_tensor(sums[s] / weights[s]);
  }
  return tensors;
}

std::vector<Tensor> smoothed(const SurfaceMesh& mesh, const std::vector<Tensor>& tensors) {
  std::vector<Tensor> means = gather_at_sectors(mesh, [&](std::size_t f, const Vec3& normal) {
    Mat2 mean = Mat2::Zero();
    for (int k = 0; k < 3; ++k) {
      mean += transported(to_matrix(tensors[mesh.corner_sector(f, k)]), mesh.corner_normal(f, k), normal);
    }
    return Mat2(mean / 3.0);
  });
  for (std::size_t s = 0; s < means.size(); ++s) {
    if (mesh.normal_is_supplied(s)) means[s] = tensors[s];
  }
  return means;
}

std::vector<Tensor> face_tensor_estimate(const SurfaceMesh& mesh, int smoothing_passes) {
  std::vector<Tensor> tensors = gather_at_sectors(
      mesh, [&mesh](std::size_t f, const Vec3& normal) { return face_tensor(mesh, f, normal); });
  bool all_exact = true;
  for (std::size_t s = 0; s < tensors.size(); ++s) all_exact = all_exact && mesh.normal_is_supplied(s);
  if (all_exact) return tensors;
  for (int pass = 0; pass < smoothing_passes; ++pass) tensors = smoothed(mesh, tensors);
  return tensors;
}

// Overwrites the tensors where a jet could be fitted; returns where it could not.
std::size_t replace_by_jets(const SurfaceMesh& mesh, const CurvatureOptions& options,
                            std::vector<Tensor>& tensors) {
  std::size_t fallbacks = 0;
  SectorNeighbourhoods neighbourhoods(mesh);
  for (std::uint32_t s = 0; s < tensors.size(); ++s) {
    const Vec3& normal = mesh.sector_normal(s);
    const auto fitted = fit_jet(neighbourhoods.points(s, options.jet_rings), normal, options.jet_degree);
    if (fitted) {
      const TangentBasis basis = tangent_basis(normal);
      tensors[s] = to_tensor(basis.transpose() * *fitted * basis);
    } else {
      ++fallbacks;
    }
  }
  return fallbacks;
}

}  // namespace

Mat3 minimal_rotation(const Vec3& from, const Vec3& to) {
  const double cosine = from.dot(to);
  constexpr double kOpposite = 1e-12;
  if (1.0 + cosine < kOpposite) {
    const Vec3 axis = Frame::around(from).tangent;
    return 2.0 * axis * axis.transpose() - Mat3::Identity();
  }
  // Rodrigues' formula with the cross product as unnormalised axis.
  const Vec3 v = from.cross(to);
  Mat3 rotation = cosine * Mat3::Identity() + v * v.transpose() / (1.0 + cosine);
  rotation(0, 1) -= v.z();
  rotation(0, 2) += v.y();
  rotation(1, 0) += v.z();
  rotation(1, 2) -= v.x();
  rotation(2, 0) -= v.y();
  rotation(2, 1) += v.x();
  return rotation;
}

PrincipalCurvatures principal_curvatures(const Mat3& shape_operator, const Vec3& normal) {
  const TangentBasis basis = tangent_basis(normal);
  const Mat2 s = basis.transpose() * shape_operator * basis;
  const double mean = 0.5 * (s(0, 0) + s(1, 1));
  const double half_difference = 0.5 * (s(0, 0) - s(1, 1));
  const double off_diagonal = 0.5 * (s(0, 1) + s(1, 0));
  const double radius = std::hypot(half_difference, off_diagonal);
  const double angle = 0.5 * std::atan2(off_diagonal, half_difference);
  const Vec3 direction = basis * Vec2(std::cos(angle), std::sin(angle));
  return {mean + radius, mean - radius, direction, normal.cross(direction)};
}

Mat3 CurvatureField::shape_operator(std::size_t sector) const {
  const TangentBasis basis = tangent_basis(mesh_->sector_normal(sector));
  return basis * to_matrix(tensors_[sector]) * basis.transpose();
}

Mat3 CurvatureField::shape_operator(std::size_t face, const Vec3& barycentric) const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) sum += barycentric[k] * mesh_->corner_normal(face, k);
  const double length = sum.norm();
  const Vec3 normal = length > 0.0 ? Vec3(sum / length) : mesh_->face_normal(face);
  Mat3 tensor = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t sector = mesh_->corner_sector(face, k);
    const Vec3& corner_normal = mesh_->sector_normal(sector);
    const TangentBasis basis = minimal_rotation(corner_normal, normal) * tangent_basis(corner_normal);
    tensor += barycentric[k] * (basis * to_matrix(tensors_[sector]) * basis.transpose());
  }
  return 0.5 * (tensor + tensor.transpose());
}

CurvatureField estimate_curvature(const SurfaceMesh& mesh, const CurvatureOptions& options) {
  VRC_CHECK(options.jet_degree >= 2 && options.jet_degree <= 4, "degree {}", options.jet_degree);
  VRC_CHECK(options.jet_rings >= 1, "{} rings", options.jet_rings);
  std::vector<Tensor> tensors = face_tensor_estimate(mesh, options.smoothing_passes);
  std::size_t fallbacks = 0;
  if (options.method == CurvatureMethod::kJet) fallbacks = replace_by_jets(mesh, options, tensors);
  return {mesh, std::move(tensors), fallbacks};
}

}  // namespace vrc
