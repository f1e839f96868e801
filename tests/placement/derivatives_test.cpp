// SPDX-License-Identifier: GPL-3.0-or-later
// Closed-form derivatives of gathered radiance against finite differences of converged radiance.
#include <gtest/gtest.h>

#include <cmath>

#include "placement_support.h"

namespace vrc {
namespace {

constexpr int kLog2Rays = 16;
constexpr int kGathers = 8;         // A converged estimate is the mean of this many.
constexpr double kFlatStep = 0.03;  // of the scene's radius
constexpr double kCurvedStep = 0.006;

/// The mean of gathers of independent seeds.
Jet2 converged(const Scene& scene, const RecordSite& site, std::uint64_t first_seed,
               bool glossy_glossy = true) {
  Jet2 sum;
  for (std::uint64_t seed = first_seed; seed < first_seed + kGathers; ++seed) {
    const Jet2 j = test::gather(scene, site, kLog2Rays, seed, glossy_glossy).luminance;
    sum.value += j.value / kGathers;
    sum.gradient += j.gradient / kGathers;
    sum.hessian += j.hessian / kGathers;
  }
  return sum;
}

/// Central differences of luminance along the surface with the given step.
Jet2 differences(const Scene& scene, const RecordSite& site, double h) {
  const auto at = [&](double x, double y) {
    return converged(scene, test::displaced(scene, site, h * Vec2(x, y)), 7).value;
  };
  const double center = at(0, 0), right = at(1, 0), left = at(-1, 0), up = at(0, 1), down = at(0, -1);
  Jet2 j;
  j.value = center;
  j.gradient = Vec2(right - left, up - down) / (2.0 * h);
  const double mixed = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / 4.0;
  j.hessian << right - 2.0 * center + left, mixed, mixed, up - 2.0 * center + down;
  j.hessian /= h * h;
  return j;
}

/// Richardson's extrapolation of two steps removes the error of second order.
Jet2 reference_derivatives(const Scene& scene, const RecordSite& site, double step_share) {
  const double h = step_share * scene.radius();
  const Jet2 wide = differences(scene, site, 2.0 * h), narrow = differences(scene, site, h);
  Jet2 j = narrow;
  j.gradient = (4.0 * narrow.gradient - wide.gradient) / 3.0;
  j.hessian = (4.0 * narrow.hessian - wide.hessian) / 3.0;
  return j;
}

struct RelativeError {
  double gradient, hessian;
};

/// RMS over the sites of the difference over that of the truth.
RelativeError relative_error(const Scene& scene, const std::vector<RecordSite>& sites,
                             const std::vector<Jet2>& truth, bool glossy_glossy) {
  double g_error = 0.0, g_truth = 0.0, h_error = 0.0, h_truth = 0.0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Jet2 estimate = converged(scene, sites[i], 100, glossy_glossy);
    g_error += (estimate.gradient - truth[i].gradient).squaredNorm();
    g_truth += truth[i].gradient.squaredNorm();
    h_error += (estimate.hessian - truth[i].hessian).squaredNorm();
    h_truth += truth[i].hessian.squaredNorm();
  }
  return {std::sqrt(g_error / g_truth), std::sqrt(h_error / h_truth)};
}

void expect_glossy_glossy_term_to_matter(const std::string& scene_name,
                                         const std::vector<Vec2>& film_shares) {
  const Scene scene = test::load_scene(scene_name, 256, 256);
  const std::vector<RecordSite> sites = test::sites_at(scene, film_shares);
  std::vector<Jet2> truth;
  for (const RecordSite& site : sites) truth.push_back(reference_derivatives(scene, site, kFlatStep));
  const RelativeError with = relative_error(scene, sites, truth, true);
  EXPECT_LT(with.gradient, 0.05);
  EXPECT_LT(with.hessian, 0.15);
  const RelativeError without = relative_error(scene, sites, truth, false);
  EXPECT_GT(without.gradient, 0.25);
  EXPECT_GT(without.hessian, 0.5);
  testing::Test::RecordProperty("gradient", std::to_string(with.gradient));
  testing::Test::RecordProperty("hessian", std::to_string(with.hessian));
  testing::Test::RecordProperty("gradient_without", std::to_string(without.gradient));
  testing::Test::RecordProperty("hessian_without", std::to_string(without.hessian));
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
  std::vector<Jet2> truth;
  for (std::size_t i = 0; i < curved.size(); ++i) {
    EXPECT_GT(curved[i].point.shape_operator.norm(), 1.0) << "not on the pillar";
    truth.push_back(reference_derivatives(scene, curved[i], kCurvedStep));
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
  const RelativeError with = relative_error(scene, curved, truth, true);
  EXPECT_LT(with.gradient, 0.05);
  EXPECT_LT(with.hessian, 0.15);
  const RelativeError without = relative_error(scene, flat, truth, true);
  EXPECT_GT(without.gradient, 0.5);
  EXPECT_GT(without.hessian, 0.7);
}

}  // namespace
}  // namespace vrc
