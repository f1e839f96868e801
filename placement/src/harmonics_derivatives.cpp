// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/harmonics_derivatives.h"

#include "core/central_differences.h"

namespace vrc {
namespace {

constexpr int kEntries = IncidentHarmonics::kEntries;
constexpr double kStepAngle = kPi / 128.0;  // [rad]

/// The length of d along a tangent that turns the mirrored direction to the camera by the step's angle.
double step_along(const RecordSite& site, int axis) {
  return kStepAngle / (2.0 * site.point.shape_operator.col(axis).norm() + 1.0 / site.to_camera.norm());
}

/// The weights of the site displaced by d.
void response_at(const BrdfHarmonics& brdf, const RecordSite& site, const Vec2& d, Eigen::MatrixXf& weights) {
  const Mat2& s = site.point.shape_operator;
  const Frame& frame = site.frame;
  const Vec2 turn = s * d;
  const Vec3 normal = (frame.normal + turn[0] * frame.tangent + turn[1] * frame.bitangent).normalized();
  const Vec3 moved = d[0] * frame.tangent + d[1] * frame.bitangent - 0.5 * d.dot(turn) * frame.normal;
  brdf.response(normal, (site.to_camera - moved).normalized(), weights);
}

}  // namespace

MovingWeights moving_weights(const BrdfHarmonics& brdf, const RecordSite& site, int order) {
  const int count = sh::coefficient_count(order);
  const double h1 = step_along(site, 0), h2 = step_along(site, 1);
  StencilValues<Eigen::MatrixXf> samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].resize(count, 3);
    const auto [i1, i2] = kDifferenceStencil[i];
    response_at(brdf, site, {h1 * i1, h2 * i2}, samples[i]);
  }
  const auto entries = central_differences(samples, static_cast<float>(h1), static_cast<float>(h2));
  MovingWeights result;
  result.coefficients.resize(count, Eigen::NoChange);
  for (int k = 0; k < kEntries; ++k) {
    for (int c = 0; c < 3; ++c)
      result.coefficients.col(kEntries * c + k) = entries[static_cast<std::size_t>(k)].col(c);
  }
  return result;
}

std::array<Jet2, 3> outgoing_radiance(const IncidentHarmonics& incident, const MovingWeights& weights) {
  std::array<Jet2, 3> result;
  for (int c = 0; c < 3; ++c) {
    // Entry (i, k): derivative i of the incident radiance times derivative k of the weights.
    Eigen::Matrix<double, kEntries, kEntries> p;
    for (int k = 0; k < kEntries; ++k)
      p.col(k) = incident.weighted(c, weights.coefficients.col(kEntries * c + k).data()).cast<double>();
    Jet2& jet = result[static_cast<std::size_t>(c)];
    jet.value = p(0, 0);
    jet.gradient = {p(1, 0) + p(0, 1), p(2, 0) + p(0, 2)};
    const double mixed = p(4, 0) + p(1, 2) + p(2, 1) + p(0, 4);
    jet.hessian << p(3, 0) + 2.0 * p(1, 1) + p(0, 3), mixed, mixed, p(5, 0) + 2.0 * p(2, 2) + p(0, 5);
  }
  return result;
}

}  // namespace vrc
