// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of the radiance that spherical harmonics give, against finite differences of converged
// radiance.
#include "placement/harmonics_derivatives.h"

#include <gtest/gtest.h>

#include "derivatives_support.h"
#include "harmonics_support.h"

namespace vrc {
namespace {

constexpr int kLog2Rays = 15;
constexpr int kOrder = 10;

test::Estimator moving_estimator(const test::HarmonicsOfScene& harmonics) {
  return [&harmonics](const RecordSite& site, std::uint64_t seed) {
    return luminance(outgoing_radiance(harmonics.incident(site, kLog2Rays, seed),
                                       moving_weights(harmonics.brdf(site), site, kOrder)));
  };
}

/// Expects both kinds of derivatives to be right, and those with fixed weights to be wrong.
void expect_right_derivatives(const Scene& scene, const std::vector<RecordSite>& sites, double step_share) {
  const std::vector<Jet2> truth = test::reference_derivatives(scene, sites, step_share);
  const test::HarmonicsOfScene harmonics(scene, kOrder);
  const test::RelativeError moving = test::relative_error(moving_estimator(harmonics), sites, truth);
  test::record_error("moving", moving);
  EXPECT_LT(moving.value, 0.02);
  EXPECT_LT(moving.gradient, 0.05);
  EXPECT_LT(moving.hessian, 0.15);
  const test::RelativeError analytic =
      test::relative_error(test::analytic_estimator(scene, kLog2Rays), sites, truth);
  test::record_error("analytic", analytic);
  EXPECT_LT(analytic.gradient, 0.05);
  EXPECT_LT(analytic.hessian, 0.15);
  const auto fixed_estimator = [&](const RecordSite& site, std::uint64_t seed) {
    return harmonics.luminance_of(harmonics.incident(site, kLog2Rays, seed), site);
  };
  const test::RelativeError fixed = test::relative_error(fixed_estimator, sites, truth);
  test::record_error("fixed", fixed);
  EXPECT_GT(fixed.gradient, 2.0 * moving.gradient);
  EXPECT_GT(fixed.hessian, 2.0 * moving.hessian);
}

TEST(HarmonicsDerivatives, MatchFiniteDifferencesInTheHalfBox) {
  const Scene scene = test::load_scene("half_box.xml", 256, 256, {{"exponent", "5"}});
  expect_right_derivatives(
      scene, test::sites_at(scene, {{0.9, 0.5}, {0.1875, 0.4375}, {0.25, 0.5}, {0.7, 0.5}, {0.75, 0.375}}),
      test::kFlatStep);
}

TEST(HarmonicsDerivatives, MatchFiniteDifferencesOnASphere) {
  // A purely glossy ball: the derivatives of a diffuse part leave out its horizon, which moves with the
  // normal.
  const Scene scene =
      test::load_scene("curved_room.xml", 256, 256, {{"short_box", "0, 0, 0"}, {"exponent", "5"}});
  const std::vector<RecordSite> sites =
      test::sites_at(scene, {{0.64, 0.76}, {0.66, 0.74}, {0.67, 0.79}, {0.69, 0.77}, {0.63, 0.79}});
  for (const RecordSite& site : sites) {
    EXPECT_NEAR(site.point.shape_operator(0, 0), 5.0, 0.2) << "not on the ball";
  }
  expect_right_derivatives(scene, sites, test::kCurvedStep);
}

TEST(MovingWeights, FollowTheDefinitionAtASite) {
  const Scene scene = test::load_scene("curved_room.xml", 64, 64, {{"exponent", "20"}});
  const RecordSite site = test::sites_at(scene, {{0.33, 0.64}})[0];
  const test::HarmonicsOfScene harmonics(scene, kOrder);
  const MovingWeights moving = moving_weights(harmonics.brdf(site), site, kOrder);
  Eigen::MatrixXf weights(sh::coefficient_count(kOrder), 3);
  harmonics.brdf(site).response(site.point.normal, site.to_camera.normalized(), weights);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT((moving.coefficients.col(IncidentHarmonics::kEntries * c) - weights.col(c)).norm(),
              1e-6f * weights.col(c).norm());
  }
  // Of the pillar's two directions one bends: there the weights change far more.
  EXPECT_GT(moving.coefficients.middleCols(1, 2).norm(), weights.col(0).norm());
}

}  // namespace
}  // namespace vrc
