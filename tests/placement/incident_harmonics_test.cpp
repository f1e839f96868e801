// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/incident_harmonics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harmonics_support.h"
#include "placement/surface_differences.h"

namespace vrc {
namespace {

constexpr int kLog2Rays = 15;
constexpr int kEntries = IncidentHarmonics::kEntries;

const std::vector<Vec2>& film_shares() {
  static const std::vector<Vec2> shares = {
      {0.9, 0.5}, {0.1875, 0.4375}, {0.25, 0.5}, {0.7, 0.5}, {0.75, 0.375}};
  return shares;
}

/// RMS over sites of the difference of luminance to that of the analytic gather with the same rays, over
/// the RMS of the latter.
double truncation_error(const Scene& scene, int order) {
  const test::HarmonicsOfScene harmonics(scene, order);
  double error = 0.0, size = 0.0;
  for (const RecordSite& site : test::sites_at(scene, film_shares())) {
    const double truth = test::gather(scene, site, kLog2Rays, 3).luminance.value;
    error += std::pow(harmonics.luminance_of(harmonics.incident(site, kLog2Rays, 3), site).value - truth, 2);
    size += truth * truth;
  }
  return std::sqrt(error / size);
}

TEST(IncidentHarmonics, ConvergeToTheGatherOnDullSurfaces) {
  const Scene scene = test::load_scene("half_box.xml", 64, 64, {{"exponent", "5"}});
  const double low = truncation_error(scene, 2), middle = truncation_error(scene, 5),
               high = truncation_error(scene, 10);
  EXPECT_GT(low, 2.0 * middle);
  EXPECT_GT(middle, 2.0 * high);
  EXPECT_LT(high, 0.01);
}

TEST(IncidentHarmonics, OfOrderTenDoNotResolveSharpLobes) {
  // Ringing, as in Figure 2 of [Zhao].
  const Scene scene = test::load_scene("half_box.xml", 64, 64);
  EXPECT_GT(truncation_error(scene, 10), 0.1);
  EXPECT_LT(truncation_error(scene, 24), 0.5 * truncation_error(scene, 10));
}

TEST(IncidentHarmonics, RoundsEachRowForItsLargestCoefficient) {
  constexpr int kCount = 81;  // no multiple of sixteen
  IncidentHarmonics::Coefficients exact = IncidentHarmonics::Coefficients::Random(3 * kEntries, kCount);
  for (int row = 0; row < exact.rows(); ++row) exact.row(row) *= std::pow(10.0f, static_cast<float>(row - 9));
  exact.row(4).setZero();
  const IncidentHarmonics harmonics(exact);
  ASSERT_EQ(harmonics.count(), kCount);
  const IncidentHarmonics::Coefficients rounded = harmonics.coefficients();
  for (int row = 0; row < exact.rows(); ++row) {
    EXPECT_LE((rounded.row(row) - exact.row(row)).cwiseAbs().maxCoeff(),
              exact.row(row).cwiseAbs().maxCoeff() / 65000.0f)
        << "row " << row;
  }
  const Eigen::VectorXf weights = Eigen::VectorXf::Random(kCount);
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXf expected = rounded.middleRows<kEntries>(kEntries * c) * weights;
    const auto sums = harmonics.weighted(c, weights.data());
    for (int k = 0; k < kEntries; ++k) {
      EXPECT_NEAR(sums[k], expected[k], 1e-5f * rounded.row(kEntries * c + k).norm() * weights.norm());
    }
  }
}

TEST(IncidentHarmonics, TellTheirNoise) {
  // Two differences tell little: the mean over sites and seeds counts.
  constexpr int kSeeds = 24, kLog2FewRays = 12;
  const Scene scene = test::load_scene("half_box.xml", 64, 64, {{"exponent", "20"}});
  const test::HarmonicsOfScene harmonics(scene, 10);
  double told = 0.0, variance = 0.0;
  for (const RecordSite& site : test::sites_at(scene, film_shares())) {
    Eigen::MatrixXf weights(harmonics.brdf(site).count(), 3);
    harmonics.brdf(site).response(site.point.normal, site.to_camera.normalized(), weights);
    double sum = 0.0, squares = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      HarmonicsGatherer::NoiseSums noise;
      const double value =
          harmonics
              .luminance_of(harmonics.incident(site, kLog2FewRays, static_cast<std::uint64_t>(seed),
                                               GatherDirections::kMixture, &noise),
                            site)
              .value;
      told += 0.5 * static_cast<double>((noise.transpose() * weights.col(1)).squaredNorm()) / kSeeds;
      sum += value;
      squares += value * value;
    }
    variance += (squares - sum * sum / kSeeds) / (kSeeds - 1);
  }
  EXPECT_GT(told, variance);
  EXPECT_LT(told, 10.0 * variance) << "lanes of a Sobol sequence converge more slowly than the whole";
}

using Coefficients = Eigen::MatrixXd;  // as IncidentHarmonics::coefficients

/// The mean of gathers of several seeds, and how far it may be off.
struct MeanCoefficients {
  Coefficients mean;
  Eigen::VectorXd variance;  ///< Of each row of the mean, all coefficients together.
};

MeanCoefficients mean_coefficients(const test::HarmonicsOfScene& harmonics, const RecordSite& site,
                                   GatherDirections directions, int gathers) {
  std::vector<Coefficients> samples;
  for (int seed = 0; seed < gathers; ++seed) {
    samples.push_back(harmonics.incident(site, kLog2Rays, static_cast<std::uint64_t>(seed), directions)
                          .coefficients()
                          .cast<double>());
  }
  Coefficients mean = samples[0];
  for (std::size_t i = 1; i < samples.size(); ++i) mean += samples[i];
  mean /= gathers;
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(mean.rows());
  for (const Coefficients& s : samples) variance += (s - mean).rowwise().squaredNorm();
  return {mean, variance / (gathers * (gathers - 1.0))};
}

/// Compares derivatives of coefficients with finite differences of coefficients beside the site.
void expect_derivatives_of_coefficients(int order) {
  constexpr int kGathers = 12;
  constexpr double kStep = 0.045;  // of the scene's radius
  const Scene scene = test::load_scene("half_box.xml", 64, 64, {{"exponent", "5"}});
  const test::HarmonicsOfScene harmonics(scene, order);
  double error[2] = {}, size[2] = {};
  for (const RecordSite& site : test::sites_at(scene, film_shares())) {
    const double h = kStep * scene.radius();
    const std::optional<SurfaceStencil> stencil = surface_stencil(scene, site, h);
    ASSERT_TRUE(stencil.has_value()) << "the surface ends beside " << site.key;
    StencilValues<Coefficients> values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = mean_coefficients(harmonics, stencil->sites[i], GatherDirections::kUniform, kGathers).mean;
    }
    const auto expected = central_differences(values, h, h);
    for (int k = 1; k < kEntries; ++k) {
      for (int c = 0; c < 3; ++c) {
        const Eigen::RowVectorXd truth = expected[static_cast<std::size_t>(k)].row(kEntries * c);
        const int degree = k < 3 ? 0 : 1;
        error[degree] += (values[0].row(kEntries * c + k) - truth).squaredNorm();
        size[degree] += truth.squaredNorm();
      }
    }
  }
  const double gradient = std::sqrt(error[0] / size[0]), hessian = std::sqrt(error[1] / size[1]);
  testing::Test::RecordProperty(fmt::format("gradient_{}", order), std::to_string(gradient));
  testing::Test::RecordProperty(fmt::format("hessian_{}", order), std::to_string(hessian));
  EXPECT_LT(gradient, 0.05) << "order " << order;
  EXPECT_LT(hessian, 0.15) << "order " << order;
}

TEST(IncidentHarmonics, HaveTheDerivativesOfTheirCoefficients) {
  for (const int order : {4, 10}) expect_derivatives_of_coefficients(order);
}

TEST(IncidentHarmonics, DoNotDependOnHowTheRaysAreDistributed) {
  constexpr int kGathers = 6;
  const Scene scene = test::load_scene("half_box.xml", 64, 64, {{"exponent", "5"}});
  const test::HarmonicsOfScene harmonics(scene, 10);
  for (const RecordSite& site : test::sites_at(scene, film_shares())) {
    const auto gather = [&](GatherDirections directions) {
      return mean_coefficients(harmonics, site, directions, kGathers);
    };
    const MeanCoefficients uniform = gather(GatherDirections::kUniform);
    for (const GatherDirections directions : {GatherDirections::kCosine, GatherDirections::kMixture}) {
      const MeanCoefficients other = gather(directions);
      for (int k = 0; k < uniform.mean.rows(); ++k) {
        const double noise = std::sqrt(other.variance[k] + uniform.variance[k]);
        EXPECT_LT((other.mean.row(k) - uniform.mean.row(k)).norm(), 3.0 * noise)
            << "entry " << k << " of " << site.key;
        if (k % kEntries == 0) {
          EXPECT_LT(noise, 0.05 * uniform.mean.row(k).norm());
        }
      }
    }
  }
}

}  // namespace
}  // namespace vrc
