// SPDX-License-Identifier: GPL-3.0-or-later
// Closed-form derivatives of gathered radiance against finite differences of converged radiance.
#include <gtest/gtest.h>

#include "derivatives_support.h"

namespace vrc {
namespace {

constexpr int kLog2Rays = 16;

void expect_glossy_glossy_term_to_matter(const std::string& scene_name,
                                         const std::vector<Vec2>& film_shares) {
  const Scene scene = test::load_scene(scene_name, 256, 256);
  const std::vector<RecordSite> sites = test::sites_at(scene, film_shares);
  const std::vector<Jet2> truth = test::reference_derivatives(scene, sites, test::kFlatStep);
  const test::RelativeError with =
      test::relative_error(test::analytic_estimator(scene, kLog2Rays), sites, truth);
  EXPECT_LT(with.gradient, 0.05);
  EXPECT_LT(with.hessian, 0.15);
  const test::RelativeError without =
      test::relative_error(test::analytic_estimator(scene, kLog2Rays, false), sites, truth);
  EXPECT_GT(without.gradient, 0.25);
  EXPECT_GT(without.hessian, 0.5);
  test::record_error("with", with);
  test::record_error("without", without);
}

TEST(RadianceDerivatives, MatchFiniteDifferencesInTheHalfBox) {
  expect_glossy_glossy_term_to_matter("half_box.xml", {{0.9375, 0.5},
                                                       {0.125, 0.4375},
                                                       {0.1875, 0.4375},
                                                       {0.0625, 0.4375},
                                                       {0.25, 0.5},
                                                       {0.7, 0.5},
                                                       {0.75, 0.375},
                                                       {0.8125, 0.375}});
}

TEST(RadianceDerivatives, MatchFiniteDifferencesOnTheGlossyFloor) {
  expect_glossy_glossy_term_to_matter("glossy_pair.xml", {{0.5, 0.5},
                                                          {0.4, 0.45},
                                                          {0.6, 0.45},
                                                          {0.45, 0.6},
                                                          {0.55, 0.6},
                                                          {0.5, 0.4},
                                                          {0.35, 0.55},
                                                          {0.65, 0.55}});
}

TEST(RadianceDerivatives, FollowTheNormalOnCurvedSurfaces) {
  // A purely glossy pillar: the derivatives of a diffuse part leave out its horizon, which moves with
  // the normal.
  const Scene scene =
      test::load_scene("curved_room.xml", 256, 256, {{"tall_box", "0, 0, 0"}, {"exponent", "20"}});
  std::vector<RecordSite> curved =
      test::sites_at(scene, {{0.33, 0.64}, {0.30, 0.64}, {0.34, 0.55}, {0.32, 0.58}, {0.31, 0.7}});
  std::vector<RecordSite> flat = curved;
  for (std::size_t i = 0; i < curved.size(); ++i) {
    EXPECT_GT(curved[i].point.shape_operator.norm(), 1.0) << "not on the pillar";
    flat[i].point.shape_operator.setZero();
    RayCounts counts;
    GatherOptions tangent_plane;
    tangent_plane.log2_rays = 10;
    const Jet2 without_operator = gather_radiance(scene, flat[i], tangent_plane, counts).luminance;
    tangent_plane.total_derivative = false;
    const Jet2 by_option = gather_radiance(scene, curved[i], tangent_plane, counts).luminance;
    EXPECT_EQ(by_option.gradient, without_operator.gradient);
    EXPECT_EQ(by_option.hessian, without_operator.hessian);
  }
  const std::vector<Jet2> truth = test::reference_derivatives(scene, curved, test::kCurvedStep);
  const test::Estimator analytic = test::analytic_estimator(scene, kLog2Rays);
  const test::RelativeError with = test::relative_error(analytic, curved, truth);
  EXPECT_LT(with.gradient, 0.05);
  EXPECT_LT(with.hessian, 0.15);
  const test::RelativeError without = test::relative_error(analytic, flat, truth);
  EXPECT_GT(without.gradient, 0.5);
  EXPECT_GT(without.hessian, 0.7);
}

}  // namespace
}  // namespace vrc
