// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "placement/surface_differences.h"
#include "placement_support.h"

// Derivatives along surfaces and the finite differences of converged radiance that they are judged by.
namespace vrc::test {

inline constexpr int kGathers = 8;         // A converged estimate is the mean of this many.
inline constexpr double kFlatStep = 0.03;  // of the scene's radius
inline constexpr double kCurvedStep = 0.006;

/// An estimate of luminance at a site from random numbers of the seed.
using Estimator = std::function<Jet2(const RecordSite& site, std::uint64_t seed)>;

/// The mean of estimates of independent seeds.
inline Jet2 converged(const Estimator& estimate, const RecordSite& site, std::uint64_t first_seed) {
  Jet2 sum;
  for (std::uint64_t seed = first_seed; seed < first_seed + kGathers; ++seed)
    sum = sum + (1.0 / kGathers) * estimate(site, seed);
  return sum;
}

/// `gather_radiance`.
inline Estimator analytic_estimator(const Scene& scene, int log2_rays, bool glossy_glossy = true) {
  return [&scene, log2_rays, glossy_glossy](const RecordSite& site, std::uint64_t seed) {
    return gather(scene, site, log2_rays, seed, glossy_glossy).luminance;
  };
}

/// Central differences of gathered luminance by two steps, extrapolated.
inline Jet2 reference_derivatives(const Scene& scene, const RecordSite& site, double step_share) {
  const Estimator estimate = analytic_estimator(scene, 16);
  const auto differences = [&](double step) {
    const std::optional<SurfaceStencil> stencil = surface_stencil(scene, site, step);
    EXPECT_TRUE(stencil.has_value()) << "the surface ends beside " << site.key;
    if (!stencil) return Jet2{};
    return differentiate(*stencil, [&](const RecordSite& s) { return converged(estimate, s, 7).value; });
  };
  const double h = step_share * scene.radius();
  return richardson(differences(h), differences(2.0 * h));
}

inline std::vector<Jet2> reference_derivatives(const Scene& scene, const std::vector<RecordSite>& sites,
                                               double step_share) {
  std::vector<Jet2> result;
  for (const RecordSite& site : sites) result.push_back(reference_derivatives(scene, site, step_share));
  return result;
}

struct RelativeError {
  double value, gradient, hessian;
};

/// RMS over the sites of the difference over that of the truth.
inline RelativeError relative_error(const Estimator& estimate, const std::vector<RecordSite>& sites,
                                    const std::vector<Jet2>& truth) {
  Vec3 error = Vec3::Zero(), size = Vec3::Zero();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Jet2 j = converged(estimate, sites[i], 100), &t = truth[i];
    error += Vec3(std::pow(j.value - t.value, 2), (j.gradient - t.gradient).squaredNorm(),
                  (j.hessian - t.hessian).squaredNorm());
    size += Vec3(t.value * t.value, t.gradient.squaredNorm(), t.hessian.squaredNorm());
  }
  const Vec3 relative = error.cwiseQuotient(size).cwiseSqrt();
  return {relative[0], relative[1], relative[2]};
}

/// Notes the errors in the test's report.
inline void record_error(const std::string& name, const RelativeError& error) {
  testing::Test::RecordProperty(name + "_gradient", std::to_string(error.gradient));
  testing::Test::RecordProperty(name + "_hessian", std::to_string(error.hessian));
}

}  // namespace vrc::test
