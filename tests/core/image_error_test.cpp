// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "support.h"

namespace vrc {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Image filled(int width, int height, float value) {
  Image image(width, height, {"R", "G", "B"});
  std::fill(image.pixels.begin(), image.pixels.end(), value);
  return image;
}

Image noisy(const Image& base, std::uint64_t seed, float amplitude) {
  test::SeededBits bits(seed);
  Image image = base;
  for (float& v : image.pixels) v += amplitude * static_cast<float>(2.0 * bits.uniform() - 1.0);
  return image;
}

TEST(ImageError, OfEqualImagesIsZero) {
  const Image image = noisy(filled(5, 4, 0.5f), 1, 0.3f);
  const ImageError error = compare_rgb(image, image);
  EXPECT_EQ(error.mse, 0.0);
  EXPECT_EQ(error.relmse, 0.0);
  EXPECT_EQ(error.max_abs, 0.0);
  EXPECT_EQ(error.mean_ratio, 1.0);
  EXPECT_EQ(error.non_finite, 0u);
}

TEST(ImageError, MatchesTheFormulasOfItsHeader) {
  Image image = filled(2, 1, 0.5f);
  Image reference = filled(2, 1, 0.25f);
  image.pixel(1, 0)[2] = 1.25f;
  reference.pixel(1, 0)[2] = 0.0f;
  const ImageError error = compare_rgb(image, reference);
  EXPECT_NEAR(error.mse, (5 * 0.0625 + 1.5625) / 6, 1e-12);
  EXPECT_NEAR(error.rmse, std::sqrt(error.mse), 1e-12);
  EXPECT_NEAR(error.relmse, (5 * 0.0625 / (0.0625 + 0.01) + 1.5625 / 0.01) / 6, 1e-9);
  EXPECT_NEAR(error.max_abs, 1.25, 1e-12);
  EXPECT_NEAR(error.mean_ratio, 3.75 / 1.25, 1e-12);
}

TEST(ImageError, BlackImagesHaveRatioOneAndABlackReferenceInfinity) {
  EXPECT_EQ(compare_rgb(filled(2, 2, 0.0f), filled(2, 2, 0.0f)).mean_ratio, 1.0);
  EXPECT_TRUE(std::isinf(compare_rgb(filled(2, 2, 1.0f), filled(2, 2, 0.0f)).mean_ratio));
}

TEST(ImageError, CountsNonFiniteValuesOfEitherImageAndLeavesThemOut) {
  Image image = filled(3, 3, 1.0f);
  Image reference = filled(3, 3, 1.0f);
  image.pixel(0, 0)[0] = kNan;
  image.pixel(1, 0)[1] = std::numeric_limits<float>::infinity();
  reference.pixel(2, 2)[2] = kNan;
  const ImageError error = compare_rgb(image, reference);
  EXPECT_EQ(error.non_finite, 3u);
  EXPECT_EQ(error.mse, 0.0);
  EXPECT_EQ(error.mean_ratio, 1.0);
}

TEST(ImageError, FindsChannelsByNameInAnyOrderAndLayer) {
  Image image(1, 1, {"indirect.B", "B", "indirect.G", "G", "R", "indirect.R"});
  image.pixels = {0.3f, 3.0f, 0.2f, 2.0f, 1.0f, 0.1f};
  Image plain(1, 1, {"R", "G", "B", "indirect.R", "indirect.G", "indirect.B"});
  plain.pixels = {1.0f, 2.0f, 3.0f, 0.1f, 0.2f, 0.4f};
  EXPECT_EQ(compare_rgb(image, plain).max_abs, 0.0);
  EXPECT_NEAR(compare_rgb(image, plain, "indirect").max_abs, 0.1, 1e-6);
}

TEST(ImageError, RejectsMissingChannelsAndOtherSizes) {
  const Image image = filled(2, 2, 0.0f);
  EXPECT_THROW(static_cast<void>(compare_rgb(image, Image(2, 2, {"Y"}))), InputError);
  EXPECT_THROW(static_cast<void>(compare_rgb(image, image, "direct")), InputError);
  EXPECT_THROW(static_cast<void>(compare_rgb(image, filled(4, 1, 0.0f))), InputError);
  EXPECT_THROW(static_cast<void>(two_half_relmse(image, image, filled(2, 3, 0.0f))), InputError);
}

TEST(ImageError, TwoHalvesCancelTheNoiseOfTheReference) {
  const Image truth = filled(128, 128, 0.5f);
  const Image first = noisy(truth, 11, 0.05f);
  const Image second = noisy(truth, 12, 0.05f);
  const double biased = compare_rgb(truth, mean_rgb(first, second)).relmse;
  EXPECT_GT(biased, 1e-3);
  EXPECT_NEAR(two_half_relmse(truth, first, second), 0.0, 0.05 * biased);
  // A true error of 0.1 is found through the same noise.
  const Image wrong = filled(128, 128, 0.6f);
  const double expected = compare_rgb(wrong, truth).relmse;
  EXPECT_NEAR(two_half_relmse(wrong, noisy(truth, 13, 0.05f), noisy(truth, 14, 0.05f)), expected,
              0.05 * expected);
}

TEST(ImageError, AThirdReferenceCancelsSkewedNoiseToo) {
  // One value in eight is bright: most pixels of both halves are too dark, where R1 + R2 is small as well.
  const auto sparkling = [](std::uint64_t seed) {
    test::SeededBits bits(seed);
    Image image = filled(256, 256, 0.1f);
    for (float& v : image.pixels) v += bits.uniform() < 0.125 ? 0.8f : 0.0f;
    return image;
  };
  const Image truth = filled(256, 256, 0.2f), first = sparkling(15), second = sparkling(16);
  const double noise = compare_rgb(truth, first).relmse;
  EXPECT_GT(two_half_relmse(truth, first, second), 0.2 * noise);
  double sum = 0.0;
  for (const float e : two_half_error_map(truth, first, second, sparkling(17)).pixels) sum += e;
  EXPECT_NEAR(sum / 65536.0, 0.0, 0.02 * noise);
}

TEST(ImageError, TwoHalfMapIsTheProductOverTheReference) {
  Image first = filled(2, 1, 0.3f);
  first.pixel(0, 0)[1] = kNan;
  const Image image = filled(2, 1, 0.5f), second = filled(2, 1, 0.6f);
  const Image map = two_half_error_map(image, first, second, filled(2, 1, 0.2f));
  EXPECT_THAT(map.channels, testing::ElementsAre("error"));
  EXPECT_TRUE(std::isnan(map.pixel(0, 0)[0]));
  EXPECT_NEAR(map.pixel(1, 0)[0], -0.02 / (0.04 + 0.01), 1e-6);
  EXPECT_THROW(static_cast<void>(two_half_error_map(image, first, second, filled(1, 1, 0.2f))), InputError);
}

TEST(ImageError, MapIsTheRootOfThePixelsRelativeError) {
  Image image = filled(2, 1, 0.5f);
  const Image reference = filled(2, 1, 0.3f);
  image.pixel(1, 0)[0] = kNan;
  const Image map = relative_error_map(image, reference);
  EXPECT_THAT(map.channels, testing::ElementsAre("error"));
  EXPECT_NEAR(map.pixels[0], std::sqrt(0.04 / (0.09 + 0.01)), 1e-6);
  EXPECT_TRUE(std::isnan(map.pixels[1]));
}

TEST(BlockMeans, AverageWholeAndPartialBlocks) {
  Image image(5, 3, {"R", "Z"});
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      image.pixel(x, y)[0] = static_cast<float>(x);
      image.pixel(x, y)[1] = static_cast<float>(y);
    }
  }
  const Image means = block_means(image, 2);
  ASSERT_EQ(means.width, 3);
  ASSERT_EQ(means.height, 2);
  EXPECT_THAT(means.pixels,
              testing::ElementsAre(0.5f, 0.5f, 2.5f, 0.5f, 4.0f, 0.5f, 0.5f, 2.0f, 2.5f, 2.0f, 4.0f, 2.0f));
  const Image whole = block_means(image, 100);
  EXPECT_THAT(whole.pixels, testing::ElementsAre(2.0f, 1.0f));
}

TEST(Crop, KeepsTheWindow) {
  Image image(4, 3, {"A"});
  for (std::size_t i = 0; i < 12; ++i) image.pixels[i] = static_cast<float>(i);
  const Image window = crop(image, 1, 1, 3, 3);
  EXPECT_EQ(window.width, 2);
  EXPECT_THAT(window.pixels, testing::ElementsAre(5.0f, 6.0f, 9.0f, 10.0f));
  EXPECT_THROW(static_cast<void>(crop(image, 1, 1, 5, 3)), std::logic_error);
}

TEST(Percentiles, AreTheNearestRanksOfFiniteValues) {
  Image image(5, 1, {"error"});
  image.pixels = {3.0f, kNan, 1.0f, 2.0f, 4.0f};
  EXPECT_THAT(percentiles(image, std::array{0.0, 0.25, 0.5, 0.51, 1.0}),
              testing::ElementsAre(1.0, 1.0, 2.0, 3.0, 4.0));
  image.pixels.assign(5, kNan);
  EXPECT_THAT(percentiles(image, std::array{0.5}), testing::ElementsAre(0.0));
}

}  // namespace
}  // namespace vrc
