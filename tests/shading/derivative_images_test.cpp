// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/derivative_images.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "render_support.h"

namespace vrc {
namespace {

DerivativeOptions quick_options() {
  DerivativeOptions options;
  options.log2_rays = 10;
  options.log2_reference_rays = 10;
  options.harmonics_order = 4;
  return options;
}

TEST(EstimateDerivatives, LieInTheTangentPlane) {
  const Scene scene = test::load_scene("glossy_pair.xml", 12, 12);
  DerivativeOptions options = quick_options();
  options.crop = CropWindow{4, 4, 7, 7};
  const DerivativeImages images = estimate_derivatives(scene, options);
  EXPECT_EQ(images.valid_count(), 9u);
  EXPECT_DOUBLE_EQ(images.step, DerivativeOptions::kStepShare * 12);
  const Vec3f n = Vec3f::UnitY();  // the floor
  for (const auto& method : images.methods) {
    ASSERT_EQ(method.size(), 144u);
    for (std::size_t p = 0; p < method.size(); ++p) {
      const WorldDerivatives& d = method[p];
      EXPECT_EQ(d.gradient.norm() > 0.0f, images.valid[p] == 1) << "pixel " << p;
      EXPECT_LE(std::abs(d.gradient.dot(n)), 1e-5f * d.gradient.norm());
      EXPECT_LE((d.hessian * n).norm(), 1e-5f * d.hessian.norm());
      EXPECT_LE((d.hessian - d.hessian.transpose()).norm(), 1e-5f * d.hessian.norm());
    }
  }
}

TEST(EstimateDerivatives, LeaveOutWhereTheSurfaceEndsWithinTheStep) {
  const Scene scene = test::load_scene("half_box.xml", 16, 16);
  DerivativeOptions options = quick_options();
  const std::size_t narrow = estimate_derivatives(scene, options).valid_count();
  options.step = 3.0;
  const std::size_t wide = estimate_derivatives(scene, options).valid_count();
  EXPECT_GT(narrow, 100u);
  EXPECT_LT(wide, narrow);
}

TEST(EstimateDerivatives, StopWhenInterrupted) {
  const Scene scene = test::load_scene("half_box.xml", 8, 8);
  const std::atomic<bool> stop{true};
  RunControl control;
  control.stop = &stop;
  EXPECT_THROW(static_cast<void>(estimate_derivatives(scene, quick_options(), control)), Interrupted);
}

TEST(DerivativeErrors, CompareValidPixelsWithTheReference) {
  DerivativeImages images;
  images.width = 4;
  images.height = 1;
  images.valid = {1, 1, 1, 0};
  for (auto& method : images.methods) method.resize(4);
  const auto gradients = [&](DerivativeMethod method, float a, float b, float c, float d) {
    auto& values = images.methods[static_cast<std::size_t>(method)];
    values[0].gradient = {a, 0.0f, 0.0f};
    values[1].gradient = {0.0f, b, 0.0f};
    values[2].gradient = {0.0f, 0.0f, c};
    values[3].gradient = {d, d, d};
  };
  gradients(DerivativeMethod::kFiniteDifferences, 1.0f, -2.0f, 4.0f, 1.0f);
  gradients(DerivativeMethod::kAnalytic, 1.5f, -2.2f, 4.0f, 100.0f);
  const DerivativeError error = gradient_error(images, DerivativeMethod::kAnalytic);
  EXPECT_NEAR(error.relative_rms, std::sqrt((0.25 + 0.04) / 21.0), 1e-6);
  EXPECT_NEAR(error.median_relative, 0.1, 1e-6);
  EXPECT_EQ(hessian_error(images, DerivativeMethod::kAnalytic).relative_rms, 0.0);
  const Image image = gradient_image(images, DerivativeMethod::kFiniteDifferences);
  EXPECT_EQ(image.pixel(1, 0)[1], -2.0f);
  EXPECT_EQ(robust_scale(images, image), 4.0);
}

}  // namespace
}  // namespace vrc
