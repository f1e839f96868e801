// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/curvature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sample_meshes.h"
#include "support.h"

namespace vrc {
namespace {

using test::make_torus;
using test::without_normals;

const Vec3 kCentre(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0);
const CurvatureOptions kJets{.method = CurvatureMethod::kJet};

Vec3 shading_normal(const SurfaceMesh& mesh, std::size_t face, const Vec3& b) {
  return (b[0] * mesh.corner_normal(face, 0) + b[1] * mesh.corner_normal(face, 1) +
          b[2] * mesh.corner_normal(face, 2))
      .normalized();
}

Vec3 point_on(const SurfaceMesh& mesh, std::size_t face, const Vec3& b) {
  const auto p = mesh.positions(face);
  return b[0] * p[0] + b[1] * p[1] + b[2] * p[2];
}

double gaussian_curvature(const Mat3& s, const Vec3& normal) {
  const PrincipalCurvatures k = principal_curvatures(s, normal);
  return k.k1 * k.k2;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

// Of the tensor, over the centres of the faces, relative to its true norm.
template <typename TrueOperator>
std::vector<double> relative_errors(const SurfaceMesh& mesh, const CurvatureField& field,
                                    const TrueOperator& true_operator) {
  std::vector<double> errors;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Mat3 expected = true_operator(point_on(mesh, f, kCentre));
    errors.push_back((field.shape_operator(f, kCentre) - expected).norm() / expected.norm());
  }
  return errors;
}

Mat3 torus_operator(const Vec3& p, double ring, double tube) {
  const Vec3 axis_point = ring * Vec3(p.x(), p.y(), 0.0).normalized();
  const Vec3 n = (p - axis_point).normalized();
  const Vec3 around = Vec3::UnitZ().cross(axis_point).normalized();
  const Vec3 across = n.cross(around);
  const double cosine = n.dot(axis_point.normalized());
  return across * across.transpose() / tube + around * around.transpose() * (cosine / (ring + tube * cosine));
}

TEST(MinimalRotation, TakesOneVectorToTheOtherAndLeavesTheirNormal) {
  test::SeededBits random(2);
  const auto direction = [&random] {
    return Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5).normalized();
  };
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = direction();
    const Vec3 b = i % 20 == 0 ? a : i % 20 == 1 ? Vec3(-a) : direction();
    const Mat3 q = minimal_rotation(a, b);
    EXPECT_LT((q * a - b).norm(), 1e-12);
    EXPECT_LT((q * q.transpose() - Mat3::Identity()).norm(), 1e-12);
    EXPECT_NEAR(q.determinant(), 1.0, 1e-12);
    const Vec3 axis = a.cross(b);
    EXPECT_LT((q * axis - axis).norm(), 1e-12);
  }
}

TEST(PrincipalCurvatures, RebuildTheTensor) {
  const Vec3 n = Vec3(1, -2, 0.5).normalized();
  const Vec3 t = n.unitOrthogonal();
  const Vec3 u = Eigen::AngleAxisd(0.4, n) * t;
  const Vec3 v = n.cross(u);
  const Mat3 s = 3.0 * u * u.transpose() - 5.0 * v * v.transpose();
  const PrincipalCurvatures k = principal_curvatures(s, n);
  EXPECT_NEAR(k.k1, 3.0, 1e-14);
  EXPECT_NEAR(k.k2, -5.0, 1e-14);
  EXPECT_NEAR(std::abs(k.direction1.dot(u)), 1.0, 1e-14);
  EXPECT_LT((k.direction1.cross(k.direction2) - n).norm(), 1e-14);
}

TEST(Curvature, TensorsAreSymmetricAndTangent) {
  for (const auto& [name, soup] : test::all_sample_meshes()) {
    SCOPED_TRACE(name);
    const SurfaceMesh mesh = build_surface_mesh(soup);
    const CurvatureField field = estimate_curvature(mesh);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      for (const Vec3& b : {kCentre, Vec3(1, 0, 0), Vec3(0.1, 0.2, 0.7)}) {
        const Mat3 s = field.shape_operator(f, b);
        EXPECT_LE((s - s.transpose()).norm(), 0.0);
        EXPECT_LE((s * shading_normal(mesh, f, b)).norm(), 1e-12 * (1.0 + s.norm()));
      }
      const Mat3 at_corner = field.shape_operator(mesh.corner_sector(f, 1));
      EXPECT_LE((field.shape_operator(f, Vec3(0, 1, 0)) - at_corner).norm(),
                1e-12 * (1.0 + at_corner.norm()));
    }
  }
}

TEST(Curvature, SphereIsOneOverItsRadius) {
  const double radius = 2.5;
  const PolygonSoup sphere = make_sphere(Vec3(3, -1, 2), radius, 16);
  for (const PolygonSoup& soup : {sphere, without_normals(sphere)}) {
    const SurfaceMesh mesh = build_surface_mesh(soup);
    for (const CurvatureOptions& options : {CurvatureOptions{}, kJets}) {
      const CurvatureField field = estimate_curvature(mesh, options);
      for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const PrincipalCurvatures k =
            principal_curvatures(field.shape_operator(f, kCentre), shading_normal(mesh, f, kCentre));
        EXPECT_NEAR(k.k1 * radius, 1.0, 0.02);
        EXPECT_NEAR(k.k2 * radius, 1.0, 0.02);
      }
    }
  }
}

TEST(Curvature, PredictsHowTheNormalTurns) {
  // The definition of S: a step d turns n into normalize(n + S d).
  const double ring = 2.0;
  const double tube = 0.7;
  const SurfaceMesh mesh = build_surface_mesh(make_torus(ring, tube, 96, 64, 0.5, true));
  const CurvatureField field = estimate_curvature(mesh);
  std::vector<double> errors;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Vec3 near(0.5, 0.3, 0.2);
    const Vec3 n = shading_normal(mesh, f, kCentre);
    const Vec3 step = point_on(mesh, f, near) - point_on(mesh, f, kCentre);
    const Vec3 predicted = (n + field.shape_operator(f, kCentre) * step).normalized();
    const Vec3 turned = shading_normal(mesh, f, near);
    errors.push_back((predicted - turned).norm() / (turned - n).norm());
  }
  EXPECT_LT(quantile(errors, 0.5), 0.02);
  EXPECT_LT(quantile(errors, 0.95), 0.1);
}

TEST(Curvature, CylinderBendsOneWayOnly) {
  const PolygonSoup cylinder = make_cylinder(Vec3(0, 0, 1), Vec3(0, 4, 1), 0.5, 64);
  for (const PolygonSoup& soup : {cylinder, without_normals(cylinder)}) {
    const SurfaceMesh mesh = build_surface_mesh(soup);
    const CurvatureField field = estimate_curvature(mesh);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const PrincipalCurvatures k =
          principal_curvatures(field.shape_operator(f, kCentre), shading_normal(mesh, f, kCentre));
      EXPECT_NEAR(k.k1, 2.0, 0.02);
      EXPECT_NEAR(k.k2, 0.0, 0.01);
      EXPECT_NEAR(std::abs(k.direction2.y()), 1.0, 1e-3);
    }
  }
}

TEST(Curvature, TorusMatchesTheFormula) {
  const double ring = 2.0;
  const double tube = 0.7;
  const auto expected = [&](const Vec3& p) { return torus_operator(p, ring, tube); };
  const auto errors_of = [&](bool exact_normals, const CurvatureOptions& options) {
    const SurfaceMesh mesh = build_surface_mesh(make_torus(ring, tube, 64, 48, 0.5, exact_normals));
    return relative_errors(mesh, estimate_curvature(mesh, options), expected);
  };
  const std::vector<double> averaged = errors_of(false, {});
  EXPECT_LT(quantile(averaged, 0.5), 0.03);
  EXPECT_LT(quantile(averaged, 0.95), 0.08);
  const std::vector<double> exact = errors_of(true, {});
  EXPECT_LT(quantile(exact, 0.5), 0.02);
  EXPECT_LT(quantile(exact, 0.95), 0.05);
  const std::vector<double> jets = errors_of(false, kJets);
  EXPECT_LT(quantile(jets, 0.5), 0.01);
  EXPECT_LT(quantile(jets, 0.95), 0.02);
}

TEST(Curvature, SaddleHasBothSigns) {
  // z = (x^2 - y^2) / 2 with the normal along +z: k = -1 along x and +1 along y at the origin.
  const SurfaceMesh mesh = build_surface_mesh(
      test::make_height_field([](double x, double y) { return 0.5 * (x * x - y * y); }, 60, 0.5));
  for (const CurvatureOptions& options : {CurvatureOptions{}, kJets}) {
    const CurvatureField field = estimate_curvature(mesh, options);
    std::size_t tested = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const Vec3 p = point_on(mesh, f, kCentre);
      if (p.head<2>().norm() > 0.1) continue;
      ++tested;
      const PrincipalCurvatures k =
          principal_curvatures(field.shape_operator(f, kCentre), shading_normal(mesh, f, kCentre));
      EXPECT_NEAR(k.k1, 1.0, 0.05);
      EXPECT_NEAR(k.k2, -1.0, 0.05);
      EXPECT_NEAR(std::abs(k.direction1.y()), 1.0, 0.02);
    }
    EXPECT_GT(tested, 10u);
  }
}

TEST(Curvature, PlaneAndCubeAreFlatUpToTheirEdges) {
  const PolygonSoup plane =
      test::make_height_field([](double x, double y) { return 0.3 * x - 0.8 * y; }, 12, 0.4);
  test::ParametricGrid side;
  side.nu = side.nv = 4;
  PolygonSoup fine_cube;
  fine_cube.source = "fine cube";
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 n = sign * Vec3::Unit(axis);
      const Vec3 t = Vec3::Unit((axis + 1) % 3);
      side.position = [=](double u, double v) {
        return Vec3(n + (2 * u - 1) * t + (2 * v - 1) * n.cross(t));
      };
      test::append(fine_cube, test::make_grid(side), Vec3::Zero());
    }
  }
  for (const PolygonSoup& soup : {plane, fine_cube, make_cube()}) {
    const SurfaceMesh mesh = build_surface_mesh(soup);
    for (const CurvatureOptions& options : {CurvatureOptions{}, kJets}) {
      const CurvatureField field = estimate_curvature(mesh, options);
      for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        for (const Vec3& b : {kCentre, Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
          EXPECT_LT(field.shape_operator(f, b).norm(), 1e-11);
        }
      }
    }
  }
  EXPECT_EQ(build_surface_mesh(fine_cube).region_count(), 6u);
}

TEST(Curvature, GaussBonnet) {
  const auto total_curvature = [](const PolygonSoup& soup) {
    const SurfaceMesh mesh = build_surface_mesh(soup);
    const CurvatureField field = estimate_curvature(mesh);
    double sum = 0.0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      sum += mesh.face_area(f) *
             gaussian_curvature(field.shape_operator(f, kCentre), shading_normal(mesh, f, kCentre));
    }
    return sum;
  };
  EXPECT_NEAR(total_curvature(without_normals(make_sphere(Vec3::Zero(), 3.0, 20))), 4.0 * kPi,
              0.01 * 4.0 * kPi);
  EXPECT_NEAR(total_curvature(make_sphere(Vec3::Zero(), 3.0, 20)), 4.0 * kPi, 0.01 * 4.0 * kPi);
  // On a torus 4 pi outside cancels -4 pi inside.
  // Averaging over neighbours flattens the inside of the tube more than the outside.
  EXPECT_NEAR(total_curvature(make_torus(2.0, 0.8, 120, 80, 0.5)), 0.0, 0.03 * 4.0 * kPi);
  EXPECT_NEAR(total_curvature(make_torus(2.0, 0.8, 120, 80, 0.5, true)), 0.0, 0.01 * 4.0 * kPi);
}

TEST(Curvature, IsInverseToScale) {
  const PolygonSoup soup = make_torus(2.0, 0.7, 24, 16, 0.5);
  const SurfaceMesh mesh = build_surface_mesh(soup);
  for (const double scale : {1e3, 1e-3}) {
    PolygonSoup scaled = soup;
    for (Vec3& p : scaled.positions) p *= scale;
    const SurfaceMesh scaled_mesh = build_surface_mesh(scaled);
    for (const CurvatureOptions& options : {CurvatureOptions{}, kJets}) {
      const CurvatureField field = estimate_curvature(mesh, options);
      const CurvatureField scaled_field = estimate_curvature(scaled_mesh, options);
      for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const Mat3 s = field.shape_operator(f, kCentre);
        EXPECT_LT((scale * scaled_field.shape_operator(f, kCentre) - s).norm(), 1e-9 * s.norm());
      }
    }
  }
}

TEST(Curvature, TurnsWithTheObject) {
  PolygonSoup soup = make_torus(2.0, 0.7, 24, 16, 0.5);
  const SurfaceMesh mesh = build_surface_mesh(soup);
  const CurvatureField field = estimate_curvature(mesh);
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(3, -1, 2).normalized()).toRotationMatrix();
  for (Vec3& p : soup.positions) p = turn * p;
  const SurfaceMesh turned_mesh = build_surface_mesh(soup);
  const CurvatureField turned = estimate_curvature(turned_mesh);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Mat3 expected = turn * field.shape_operator(f, kCentre) * turn.transpose();
    EXPECT_LT((turned.shape_operator(f, kCentre) - expected).norm(), 1e-10 * expected.norm());
  }
}

TEST(Curvature, ContinuousAcrossSmoothEdges) {
  const SurfaceMesh mesh = build_surface_mesh(make_torus(2.0, 0.7, 24, 16, 0.5));
  const CurvatureField field = estimate_curvature(mesh);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t g = mesh.neighbour(f, k);
      const OpenMesh::HalfedgeHandle h = face_halfedge(mesh.mesh(), f, k);
      const int across = halfedge_corner(mesh.mesh(), mesh.mesh().opposite_halfedge_handle(h));
      Vec3 here = Vec3::Zero();
      here[k] = 0.3;
      here[(k + 1) % 3] = 0.7;
      Vec3 there = Vec3::Zero();
      there[across] = 0.7;
      there[(across + 1) % 3] = 0.3;
      const Mat3 s = field.shape_operator(f, here);
      EXPECT_LT((s - field.shape_operator(g, there)).norm(), 1e-12 * s.norm());
    }
  }
}

TEST(Curvature, ReversedFacesReverseTheSign) {
  PolygonSoup soup = without_normals(make_sphere(Vec3::Zero(), 1.0, 8));
  const SurfaceMesh mesh = build_surface_mesh(soup);
  for (std::size_t f = 0; f < soup.face_count(); ++f) {
    std::reverse(soup.corner_position.begin() + soup.face_begin[f],
                 soup.corner_position.begin() + soup.face_begin[f + 1]);
  }
  const SurfaceMesh reversed = build_surface_mesh(soup);
  const CurvatureField field = estimate_curvature(reversed);
  for (std::size_t f = 0; f < reversed.face_count(); ++f) {
    EXPECT_LT(field.shape_operator(f, kCentre).trace(), -1.9);
  }
}

TEST(CurvatureJets, NeedEnoughSurroundings) {
  const SurfaceMesh cube = build_surface_mesh(make_cube());
  EXPECT_EQ(estimate_curvature(cube, kJets).fallback_count(), cube.sector_count());
  EXPECT_EQ(estimate_curvature(cube).fallback_count(), 0u);
  const SurfaceMesh torus = build_surface_mesh(make_torus(2.0, 0.7, 24, 16));
  EXPECT_EQ(estimate_curvature(torus, kJets).fallback_count(), 0u);
}

TEST(CurvatureJets, AgreeWithFaceTensors) {
  const SurfaceMesh mesh = build_surface_mesh(test::make_height_field(
      [](double x, double y) { return 0.3 * std::sin(2 * x) * std::cos(1.5 * y); }, 50, 0.5));
  const CurvatureField tensors = estimate_curvature(mesh);
  const CurvatureField jets = estimate_curvature(mesh, kJets);
  std::vector<double> differences;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    differences.push_back((tensors.shape_operator(f, kCentre) - jets.shape_operator(f, kCentre)).norm());
  }
  EXPECT_LT(quantile(differences, 0.5), 0.03);
  EXPECT_LT(quantile(differences, 0.9), 0.1);
}

}  // namespace
}  // namespace vrc
