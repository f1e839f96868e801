// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/irradiance.h"

#include <gtest/gtest.h>

#include "placement/surface_differences.h"
#include "placement_support.h"
#include "transport/brdf_harmonics.h"

namespace vrc {
namespace {

/// The diffuse Cornell box: sites on its floor and walls, away from creases.
class Irradiance : public testing::Test {
 protected:
  Scene scene_ = test::load_scene("cornell_glossy.xml", 128, 128, {{"specular", "0"}});
  std::vector<RecordSite> sites_ =
      test::sites_at(scene_, {{0.2, 0.95}, {0.5, 0.96}, {0.5, 0.3}, {0.85, 0.3}, {0.1, 0.7}});
  RayCounts counts_;

  [[nodiscard]] static GatherOptions options(int log2_rays) {
    GatherOptions options;
    options.log2_rays = log2_rays;
    return options;
  }
  [[nodiscard]] IrradianceEstimate gather(const RecordSite& site, IrradianceDerivatives kind,
                                          int log2_rays = 14) {
    return gather_irradiance(scene_, site, options(log2_rays), kind, counts_);
  }
};

TEST_F(Irradiance, IsWhatALambertLobeReflects) {
  for (const RecordSite& site : sites_) {
    const RadianceEstimate truth = gather_radiance(scene_, site, options(15), counts_);
    const Rgb albedo = scene_.bsdfs()[static_cast<std::size_t>(site.point.material)].albedo();
    for (const auto kind : {IrradianceDerivatives::kStrata, IrradianceDerivatives::kTriangles}) {
      const IrradianceEstimate e = gather(site, kind);
      for (std::size_t c = 0; c < 3; ++c) {
        const double radiance =
            static_cast<double>(albedo[static_cast<int>(c)]) / kPi * e.irradiance[c].value;
        EXPECT_NEAR(radiance, truth.radiance[c].value, 0.02 * truth.luminance.value);
      }
      EXPECT_NEAR(e.hits.mean_inverse, truth.hits.mean_inverse, 0.05 * truth.hits.mean_inverse);
    }
  }
}

TEST_F(Irradiance, ChangesAsFiniteDifferencesSay) {
  constexpr double kStep = 0.02;
  constexpr std::uint64_t kGathers = 16;  // one light sample a ray is noisy
  double strata = 0.0, triangles = 0.0, truth = 0.0;
  for (const RecordSite& site : sites_) {
    const auto mean_at = [&](const Vec2& d, IrradianceDerivatives kind) {
      Jet2 mean;
      for (std::uint64_t k = 0; k < kGathers; ++k) {
        RecordSite moved = displaced_site(scene_, site, d).value();
        moved.key = 77 + k;
        const Jet2 e = luminance(gather(moved, kind).irradiance);
        mean.value += e.value / kGathers;
        mean.gradient += e.gradient / kGathers;
      }
      return mean;
    };
    const auto value_at = [&](const Vec2& d) { return mean_at(d, IrradianceDerivatives::kTriangles).value; };
    const Vec2 expected((value_at({kStep, 0}) - value_at({-kStep, 0})) / (2 * kStep),
                        (value_at({0, kStep}) - value_at({0, -kStep})) / (2 * kStep));
    const auto error = [&](IrradianceDerivatives kind) {
      return (mean_at(Vec2::Zero(), kind).gradient - expected).squaredNorm();
    };
    strata += error(IrradianceDerivatives::kStrata);
    triangles += error(IrradianceDerivatives::kTriangles);
    truth += expected.squaredNorm();
  }
  EXPECT_LT(std::sqrt(strata / truth), 0.25);
  EXPECT_LT(std::sqrt(triangles / truth), 0.25);
}

TEST_F(Irradiance, RotatesWithTheNormal) {
  constexpr double kTurn = 0.1;
  double error = 0.0, change = 0.0;
  for (const RecordSite& site : sites_) {
    const IrradianceEstimate e = gather(site, IrradianceDerivatives::kStrata, 16);
    EXPECT_LT(std::abs(e.rotation[1].dot(site.point.normal)), 1e-9);
    for (const Vec3& axis : {site.frame.tangent, site.frame.bitangent}) {
      const auto irradiance_turned = [&](double angle) {
        RecordSite turned = site;
        turned.point.normal = (site.point.normal + angle * axis).normalized();
        turned.frame = Frame::around(turned.point.normal);
        return gather(turned, IrradianceDerivatives::kStrata, 16).irradiance[1].value;
      };
      const double difference = (irradiance_turned(kTurn) - irradiance_turned(-kTurn)) / (2.0 * kTurn);
      error += std::pow(difference - e.rotation[1].dot(axis), 2);
      change += difference * difference;
    }
  }
  EXPECT_LT(std::sqrt(error / change), 0.1);
}

TEST_F(Irradiance, AsHarmonicsGivesItselfBack) {
  const BrdfHarmonicsSet brdfs(scene_.bsdfs(), 1);
  const RecordSite& site = sites_[1];
  const IrradianceEstimate e = gather(site, IrradianceDerivatives::kTriangles);
  const IncidentHarmonics harmonics = as_harmonics(e, site.point.normal);
  const auto material = static_cast<std::size_t>(site.point.material);
  const Rgb albedo = scene_.bsdfs()[material].albedo();
  for (const Vec3& normal :
       {site.point.normal, (site.point.normal + 0.2 * site.frame.tangent).normalized().eval()}) {
    Eigen::MatrixXf weights(4, 3);
    brdfs.of(material).response(normal, site.to_camera.normalized(), weights);
    const std::array<Jet2, 3> radiance = outgoing_radiance(harmonics, weights);
    for (std::size_t c = 0; c < 3; ++c) {
      const double share = static_cast<double>(albedo[static_cast<int>(c)]) / kPi;
      const double expected = e.irradiance[c].value + e.rotation[c].dot(normal - site.point.normal);
      EXPECT_NEAR(radiance[c].value, share * expected, 1e-3 * share * expected);
      EXPECT_NEAR(radiance[c].gradient[0], share * e.irradiance[c].gradient[0],
                  1e-3 * share * e.irradiance[c].gradient.norm());
      EXPECT_NEAR(radiance[c].hessian(0, 1), share * e.irradiance[c].hessian(0, 1),
                  1e-3 * share * e.irradiance[c].hessian.norm());
    }
  }
}

}  // namespace
}  // namespace vrc
