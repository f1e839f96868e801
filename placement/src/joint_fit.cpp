// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/joint_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "placement/chart_points.h"

namespace vrc {
namespace {

// Relative error of a second-order Taylor polynomial at k = 1, growing with k^3.
constexpr double kModelError = 0.05;
// Relative floor of a value's standard deviation: no estimate is exact.
constexpr double kValueFloor = 1e-3;

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Coefficients of (value, g1, g2, h11, h12, h22) in the Taylor polynomial at d.
Vec6 taylor_basis(const Vec2& d) {
  Vec6 basis;
  basis << 1.0, d[0], d[1], 0.5 * d[0] * d[0], d[0] * d[1], 0.5 * d[1] * d[1];
  return basis;
}

Vec6 to_vector(const Jet2& j) {
  Vec6 v;
  v << j.value, j.gradient[0], j.gradient[1], j.hessian(0, 0), j.hessian(0, 1), j.hessian(1, 1);
  return v;
}

Jet2 to_jet(const Vec6& v) {
  Jet2 j;
  j.value = v[0];
  j.gradient = {v[1], v[2]};
  j.hessian << v[3], v[4], v[4], v[5];
  return j;
}

std::array<Jet2, 3> fit(const ChartPoints& centers, std::span<const RadianceRecord> records,
                        const SurfaceReach& reach, std::size_t index, double mean_luminance) {
  const RadianceRecord& record = records[index];
  const double scale = perceived(record.estimate.luminance.value, mean_luminance);
  const double length = std::sqrt(record.region.radius1 * record.region.radius2);

  // Lengths in units of the region's mean radius, so that the normal equations are well scaled.
  Vec6 unit;
  unit << 1.0, length, length, length * length, length * length, length * length;
  const double floor = kValueFloor * scale;
  Vec6 precision = to_vector(record.estimate.variance).cwiseProduct(unit.cwiseAbs2());
  precision = (precision.array() + floor * floor).inverse().matrix();

  Mat6 normal = precision.asDiagonal();
  std::array<Vec6, 3> right;
  for (std::size_t c = 0; c < 3; ++c) {
    right[c] = precision.cwiseProduct(to_vector(record.estimate.radiance[c]).cwiseProduct(unit));
  }
  const auto add_neighbour = [&](std::uint32_t i) {
    const RadianceRecord& other = records[i];
    if (i == index) return;
    const double k = joint_distance(record.region, other.region.center, other.region.normal);
    if (k >= kFitSupport || !reach.contains(other.site.point.triangle)) return;
    const Vec3 d = other.region.center - record.region.center;
    const Vec2 offset(d.dot(record.site.frame.tangent), d.dot(record.site.frame.bitangent));
    const Vec6 basis = taylor_basis(offset / length);
    const Vec2 tilt = tilt_beyond_shape(record.site, offset, other.region.normal);
    const double model = kModelError * scale * k * k * k;
    const double weight = 1.0 / (other.variance() + floor * floor + model * model);
    normal += weight * basis * basis.transpose();
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = other.estimate.radiance[c].value - record.estimate.tilt[c].change(offset, tilt);
      right[c] += weight * value * basis;
    }
  };
  std::vector<std::uint32_t> near;
  for (const PatchBox& box : reach.boxes) {
    centers.for_each_near(box, [&near](std::uint32_t i) { near.push_back(i); });
  }
  std::ranges::sort(near);  // so that rounding does not depend on how the centres are stored
  std::ranges::for_each(near, add_neighbour);
  const Eigen::LDLT<Mat6> solver(normal);
  std::array<Jet2, 3> result;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec6 solution = solver.solve(right[c]).cwiseQuotient(unit);
    result[c] = solution.allFinite() ? to_jet(solution) : record.estimate.radiance[c];
  }
  return result;
}

}  // namespace

void fit_jointly(const SceneCharts& charts, std::vector<RadianceRecord>& records,
                 std::span<const SurfaceReach> reaches, const RegionRule& rule) {
  std::vector<ChartPoint> points;
  points.reserve(records.size());
  for (const RadianceRecord& record : records) {
    const SurfacePoint& p = record.site.point;
    points.push_back({charts.patch_of(p.triangle),
                      charts.uv(p.triangle, static_cast<double>(p.u), static_cast<double>(p.v))});
  }
  const ChartPoints centers(charts.patch_count(), points);
  // Only `radiance` and `clamp_factor` change, which no fit reads.
  parallel_for(records.size(), [&](std::size_t i) {
    if (records[i].uses_harmonics()) return;
    set_radiance(records[i], fit(centers, records, reaches[i], i, rule.mean_luminance), rule.mean_luminance);
  });
}

}  // namespace vrc
