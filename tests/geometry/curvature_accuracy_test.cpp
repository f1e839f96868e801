// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of principal curvatures and directions on surfaces whose curvature is known, with irregular
// triangles, as they are and with 2 % of an edge as noise along the normals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/hash.h"
#include "geometry/curvature.h"
#include "sample_meshes.h"

namespace vrc {
namespace {

const Vec3 kCentre(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0);

struct LocalShape {
  Mat3 shape_operator;
  Vec3 normal;
};

struct AnalyticSurface {
  std::string name;
  PolygonSoup soup;
  std::function<LocalShape(const Vec3&)> at;       // Nearest to a point.
  std::function<bool(const Vec3&)> away_from_rim;  // Where the estimate has neighbours all round.
};

// z = h with derivatives (h_x, h_y, h_xx, h_xy, h_yy) and the normal towards +z.
LocalShape graph_shape(const std::array<double, 5>& h) {
  Eigen::Matrix<double, 3, 2> tangents;
  tangents << 1.0, 0.0, 0.0, 1.0, h[0], h[1];
  const Vec3 normal = Vec3(-h[0], -h[1], 1.0).normalized();
  Mat2 second;
  second << h[2], h[3], h[3], h[4];
  const Mat2 inverse = (tangents.transpose() * tangents).inverse();
  return {-tangents * inverse * (second * normal.z()) * inverse * tangents.transpose(), normal};
}

LocalShape sphere_shape(const Vec3& p, double radius) {
  const Vec3 n = p.normalized();
  return {(Mat3::Identity() - n * n.transpose()) / radius, n};
}

LocalShape torus_shape(const Vec3& p, double ring, double tube) {
  const Vec3 out = Vec3(p.x(), p.y(), 0.0).normalized();
  const Vec3 n = (p - ring * out).normalized();
  const Vec3 around = Vec3::UnitZ().cross(out);
  const Vec3 across = n.cross(around);
  const double cosine = n.dot(out);
  return {across * across.transpose() / tube + around * around.transpose() * cosine / (ring + tube * cosine),
          n};
}

LocalShape capped_cylinder_shape(const Vec3& p, double radius, double half_height) {
  if (std::abs(p.z()) > 0.98 * half_height && p.head<2>().norm() < 0.98 * radius)
    return {Mat3::Zero(), Vec3(0.0, 0.0, p.z() > 0.0 ? 1.0 : -1.0)};
  const Vec3 n = Vec3(p.x(), p.y(), 0.0).normalized();
  const Vec3 around = Vec3::UnitZ().cross(n);
  return {around * around.transpose() / radius, n};
}

AnalyticSurface make_band_of_sphere() {
  test::ParametricGrid grid;
  grid.position = [](double u, double v) {
    const double a = 2.0 * kPi * u;
    const double z = 1.6 * (v - 0.5);  // Equal areas.
    return Vec3(2.0 * Vec3(std::sqrt(1.0 - z * z) * std::cos(a), std::sqrt(1.0 - z * z) * std::sin(a), z));
  };
  grid.nu = 64;
  grid.nv = 20;
  grid.wrap_u = true;
  grid.jitter = 0.5;
  return {"sphere", test::make_grid(grid), [](const Vec3& p) { return sphere_shape(p, 2.0); },
          [](const Vec3& p) { return std::abs(p.z()) < 1.3; }};
}

AnalyticSurface make_capped_cylinder() {
  constexpr double kRadius = 0.8;
  constexpr double kHalf = 1.5;
  test::ParametricGrid side;
  side.nu = 48;
  side.nv = 26;
  side.wrap_u = true;
  const auto wobble = [](double u, double v, std::uint64_t key) {
    const auto bits =
        hash(key, static_cast<std::uint64_t>(std::lround(1e4 * u) * 20000 + std::lround(1e4 * v)));
    const bool rim = v <= 0.0 || v >= 1.0;  // Where the parts meet.
    return rim ? 0.0 : static_cast<double>(bits >> 11) * 0x1.0p-53 - 0.5;
  };
  side.position = [=](double u, double v) {
    const double a = 2.0 * kPi * (u + 0.5 * wobble(u, v, 1) / 48);
    return Vec3(kRadius * std::cos(a), kRadius * std::sin(a),
                kHalf * (2.0 * (v + 0.5 * wobble(u, v, 2) / 26) - 1.0));
  };
  AnalyticSurface surface{"capped cylinder", test::make_grid(side),
                          [](const Vec3& p) { return capped_cylinder_shape(p, kRadius, kHalf); },
                          [](const Vec3&) { return true; }};
  for (const double end : {-kHalf, kHalf}) {
    test::ParametricGrid cap = side;
    cap.nv = 8;
    cap.position = [=](double u, double v) {
      const double w = v <= 0.0 ? 0.0 : v + 0.4 * wobble(u, v, 3) / 8;
      const double r = kRadius * (1.0 - 0.9 * w);  // A small hole in the middle.
      const double a = 2.0 * kPi * (end > 0.0 ? u : -u);
      return Vec3(r * std::cos(a), r * std::sin(a), end);
    };
    test::append(surface.soup, test::make_grid(cap), Vec3::Zero());
  }
  return surface;
}

std::vector<AnalyticSurface> analytic_surfaces() {
  const auto inner = [](const Vec3& p) { return std::max(std::abs(p.x()), std::abs(p.y())) < 0.8; };
  return {
      make_band_of_sphere(),
      {"torus", test::make_torus(2.0, 0.7, 96, 40, 0.5),
       [](const Vec3& p) { return torus_shape(p, 2.0, 0.7); }, [](const Vec3&) { return true; }},
      make_capped_cylinder(),
      {"saddle", test::make_height_field([](double x, double y) { return 0.5 * (x * x - y * y); }, 28, 0.5),
       [](const Vec3& p) {
         return graph_shape({p.x(), -p.y(), 1.0, 0.0, -1.0});
       },
       inner},
      {"paraboloid",
       test::make_height_field([](double x, double y) { return 0.5 * x * x + 0.2 * y * y; }, 28, 0.5),
       [](const Vec3& p) {
         return graph_shape({p.x(), 0.4 * p.y(), 1.0, 0.0, 0.4});
       },
       inner}};
}

// Moves each position along the normal there by up to `share` of a typical edge, either way.
void add_noise(AnalyticSurface& surface, double share) {
  const SurfaceMesh mesh = build_surface_mesh(surface.soup);
  double area = 0.0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) area += mesh.face_area(f);
  const double edge = std::sqrt(area / static_cast<double>(mesh.face_count()) * 4.0 / std::sqrt(3.0));
  for (Vec3& p : surface.soup.positions) {
    // Equal positions move alike.
    const auto bits = [](double x) { return static_cast<std::uint64_t>(std::llround(1e9 * x)); };
    const auto h = hash(hash(bits(p.x()), bits(p.y())), bits(p.z()));
    p += share * edge * (2.0 * (static_cast<double>(h >> 11) * 0x1.0p-53) - 1.0) * surface.at(p).normal;
  }
}

struct Errors {
  std::vector<double> curvature;  // Of both, by the larger true one.
  std::vector<double> direction;  // Where the two differ clearly. [radians]
};

double quantile(std::vector<double> values, double q) {
  EXPECT_FALSE(values.empty());
  if (values.empty()) return 1e9;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

Errors errors_of(const AnalyticSurface& surface, const CurvatureOptions& options) {
  const SurfaceMesh mesh = build_surface_mesh(surface.soup);
  const CurvatureField field = estimate_curvature(mesh, options);
  Errors errors;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto p = mesh.positions(f);
    const Vec3 point = (p[0] + p[1] + p[2]) / 3.0;
    if (!surface.away_from_rim(point)) continue;
    const Vec3 normal =
        (mesh.corner_normal(f, 0) + mesh.corner_normal(f, 1) + mesh.corner_normal(f, 2)).normalized();
    const LocalShape truth = surface.at(point);
    const PrincipalCurvatures expected = principal_curvatures(truth.shape_operator, truth.normal);
    const PrincipalCurvatures k = principal_curvatures(field.shape_operator(f, kCentre), normal);
    const double size = std::max(std::abs(expected.k1), std::abs(expected.k2));
    if (size < 1e-9) {  // Flat: an absolute measure, by the length 1 of these surfaces.
      errors.curvature.push_back(std::max(std::abs(k.k1), std::abs(k.k2)));
      continue;
    }
    errors.curvature.push_back(std::max(std::abs(k.k1 - expected.k1), std::abs(k.k2 - expected.k2)) / size);
    if (expected.k1 - expected.k2 < 0.3 * size) continue;
    errors.direction.push_back(std::acos(std::min(1.0, std::abs(k.direction1.dot(expected.direction1)))));
  }
  return errors;
}

struct Bounds {
  double median, high;                      // Of the curvature; high: the 95th percentile.
  double direction_median, direction_high;  // [radians]
};

void expect_within(const Errors& errors, const Bounds& bounds) {
  EXPECT_LT(quantile(errors.curvature, 0.5), bounds.median);
  EXPECT_LT(quantile(errors.curvature, 0.95), bounds.high);
  if (errors.direction.empty()) return;
  EXPECT_LT(quantile(errors.direction, 0.5), bounds.direction_median);
  EXPECT_LT(quantile(errors.direction, 0.95), bounds.direction_high);
}

TEST(CurvatureAccuracy, TensorsOnCleanSurfaces) {
  for (const AnalyticSurface& surface : analytic_surfaces()) {
    SCOPED_TRACE(surface.name);
    expect_within(errors_of(surface, {}), {0.03, 0.07, 0.03, 0.10});
  }
}

TEST(CurvatureAccuracy, TensorsOnNoisySurfaces) {
  for (AnalyticSurface& surface : analytic_surfaces()) {
    SCOPED_TRACE(surface.name);
    add_noise(surface, 0.02);
    expect_within(errors_of(surface, {}), {0.15, 0.70, 0.10, 0.40});
  }
}

TEST(CurvatureAccuracy, JetsOnCleanSurfaces) {
  for (const AnalyticSurface& surface : analytic_surfaces()) {
    SCOPED_TRACE(surface.name);
    expect_within(errors_of(surface, {.method = CurvatureMethod::kJet}), {0.01, 0.04, 0.01, 0.03});
  }
}

TEST(CurvatureAccuracy, JetsOnNoisySurfaces) {
  for (AnalyticSurface& surface : analytic_surfaces()) {
    SCOPED_TRACE(surface.name);
    add_noise(surface, 0.02);
    expect_within(errors_of(surface, {.method = CurvatureMethod::kJet}), {0.22, 2.0, 0.15, 0.60});
  }
}

}  // namespace
}  // namespace vrc
