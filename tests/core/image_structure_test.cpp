// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image_structure.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "support.h"

namespace vrc {
namespace {

Image filled(int width, int height, float value) {
  Image image(width, height, {"R", "G", "B"});
  std::ranges::fill(image.pixels, value);
  return image;
}

/// Grey with independent noise in every pixel.
Image noisy(const Image& base, std::uint64_t seed, float amplitude) {
  test::SeededBits bits(seed);
  Image image = base;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    const float v = amplitude * static_cast<float>(2.0 * bits.uniform() - 1.0);
    for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * p + c] += v;
  }
  return image;
}

TEST(Ssim, OfEqualPicturesIsOne) {
  const Image image = noisy(filled(20, 13, 0.5f), 1, 0.4f);
  EXPECT_NEAR(mean_ssim(image, image), 1.0, 1e-12);
  EXPECT_NEAR(mean_ssim(filled(1, 1, 0.3f), filled(1, 1, 0.3f)), 1.0, 1e-12);
}

TEST(Ssim, OfFlatPicturesIsTheirLuminanceTerm) {
  const double a = 0.4, b = 0.6, c1 = 1e-4;
  EXPECT_NEAR(mean_ssim(filled(9, 9, 0.4f), filled(9, 9, 0.6f)), (2 * a * b + c1) / (a * a + b * b + c1),
              1e-6);
}

TEST(Ssim, OfLessContrastIsItsContrastTerm) {
  // y = mean + g (x - mean): with a variance far above C2 that is 2 g / (1 + g^2), and the means hardly
  // differ.
  const Image x = noisy(filled(64, 64, 0.5f), 2, 0.5f);
  Image y = x;
  for (float& v : y.pixels) v = 0.5f + 0.5f * (v - 0.5f);
  EXPECT_NEAR(mean_ssim(x, y), 2 * 0.5 / (1 + 0.25), 0.02);
}

TEST(Ssim, OfUnrelatedNoiseIsNearZeroAndSymmetric) {
  const Image grey = filled(64, 64, 0.5f);
  const Image x = noisy(grey, 3, 0.5f), y = noisy(grey, 4, 0.5f);
  EXPECT_LT(std::abs(mean_ssim(x, y)), 0.1);
  EXPECT_DOUBLE_EQ(mean_ssim(x, y), mean_ssim(y, x));
}

TEST(Ssim, RefusesPicturesThatCannotBeCompared) {
  EXPECT_THROW(static_cast<void>(mean_ssim(filled(4, 4, 0), filled(4, 5, 0))), InputError);
  EXPECT_THROW(static_cast<void>(mean_ssim(Image(2, 2, {"Y"}), Image(2, 2, {"Y"}))), InputError);
}

}  // namespace
}  // namespace vrc
