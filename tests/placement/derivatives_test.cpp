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
    // The same up to the order of sums.
    EXPECT_LT((by_option.gradient - without_operator.gradient).norm(), 1e-4 * by_option.gradient.norm());
    EXPECT_LT((by_option.hessian - without_operator.hessian).norm(), 1e-4 * by_option.hessian.norm());
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

/// `moved`, a site beside `site`, with the normal n + S d + tau of the latter's frame.
RecordSite tilted(RecordSite moved, const RecordSite& site, const Vec2& d, const Vec2& tau) {
  const Vec2 m = site.point.shape_operator * d + tau;
  moved.point.normal =
      (site.frame.normal + m[0] * site.frame.tangent + m[1] * site.frame.bitangent).normalized();
  moved.frame = Frame::around(moved.point.normal);
  return moved;
}

/// RMS of differences over that of what was expected.
struct Differences {
  double error = 0.0, size = 0.0;
  void add(const auto& found, const auto& expected) {
    error += (found - expected).squaredNorm();
    size += expected.squaredNorm();
  }
  [[nodiscard]] double relative() const { return std::sqrt(error / size); }
};

TEST(RadianceDerivatives, FollowTiltsOfTheNormal) {
  const Scene scene =
      test::load_scene("curved_room.xml", 256, 256, {{"tall_box", "0, 0, 0"}, {"exponent", "20"}});
  const std::vector<RecordSite> sites =
      test::sites_at(scene, {{0.33, 0.64}, {0.30, 0.64}, {0.34, 0.55}, {0.32, 0.58}, {0.31, 0.7}});
  constexpr double kTilt = 0.02;
  const double step = test::kCurvedStep * scene.radius();
  Differences gradients, mixed, hessians;
  const test::Estimator estimate = test::analytic_estimator(scene, kLog2Rays);
  for (const RecordSite& site : sites) {
    TiltJet found;
    for (std::uint64_t seed = 100; seed < 100 + test::kGathers; ++seed) {
      const auto& tilts = test::gather(scene, site, kLog2Rays, seed).tilt;
      for (std::size_t c = 0; c < 3; ++c) {
        const double share = kLuminance[c] / test::kGathers;
        found.gradient += share * tilts[c].gradient;
        found.mixed += share * tilts[c].mixed;
        found.hessian += share * tilts[c].hessian;
      }
    }
    // In units of the steps.
    const auto at = [&](const Vec2& d, const Vec2& tau) {
      const auto moved = d.isZero() ? site : displaced_site(scene, site, step * d);
      EXPECT_TRUE(moved.has_value());
      return test::converged(estimate, tilted(*moved, site, step * d, kTilt * tau), 7).value;
    };
    const Vec2 none = Vec2::Zero();
    Vec2 gradient;
    Mat2 by_both, hessian;
    const double centre = at(none, none);
    for (int j = 0; j < 2; ++j) {
      const Vec2 tau = Vec2::Unit(j);
      const double more = at(none, tau), less = at(none, -tau);
      gradient[j] = (more - less) / (2.0 * kTilt);
      hessian(j, j) = (more - 2.0 * centre + less) / (kTilt * kTilt);
      for (int i = 0; i < 2; ++i) {
        const Vec2 d = Vec2::Unit(i);
        by_both(i, j) = (at(d, tau) - at(d, -tau) - at(-d, tau) + at(-d, -tau)) / (4.0 * step * kTilt);
      }
    }
    hessian(0, 1) = hessian(1, 0) =
        (at(none, {1, 1}) - at(none, {1, -1}) - at(none, {-1, 1}) + at(none, {-1, -1})) /
        (4.0 * kTilt * kTilt);
    gradients.add(found.gradient, gradient);
    mixed.add(found.mixed, by_both);
    hessians.add(found.hessian, hessian);
  }
  EXPECT_LT(gradients.relative(), 0.05);
  EXPECT_LT(mixed.relative(), 0.15);
  EXPECT_LT(hessians.relative(), 0.15);
}

TEST(RadianceDerivatives, HaveNoTiltsWhereTheyFollowTheTangentPlane) {
  const Scene scene = test::load_scene("curved_room.xml", 128, 128);
  const RecordSite site = test::sites_at(scene, {{0.33, 0.64}})[0];
  RayCounts counts;
  GatherOptions options;
  options.log2_rays = 10;
  EXPECT_GT(gather_radiance(scene, site, options, counts).tilt[0].gradient.norm(), 0.0);
  options.total_derivative = false;
  EXPECT_EQ(gather_radiance(scene, site, options, counts).tilt[0].gradient.norm(), 0.0);
}

}  // namespace
}  // namespace vrc
