// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/display.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace vrc {
namespace {

TEST(Display, BrightensByPowersOfTwo) {
  EXPECT_TRUE(displayed(Rgb(0.25f, 0.5f, 3.0f), {1.0, Tonemap::kNone}).isApprox(Rgb(0.5f, 1.0f, 6.0f)));
}

TEST(Display, ReinhardKeepsTheHueAndMapsLuminanceOneToAHalf) {
  EXPECT_TRUE(displayed(Rgb::Ones(), {0.0, Tonemap::kReinhard}).isApprox(Rgb::Constant(0.5f), 1e-5f));
  const Rgb color(4.0f, 2.0f, 1.0f);
  const Rgb shown = displayed(color, {0.0, Tonemap::kReinhard});
  EXPECT_TRUE((shown / shown[2]).isApprox(color, 1e-5f));
  EXPECT_NEAR(luminance(shown), luminance(color) / (1.0f + luminance(color)), 1e-5f);
}

TEST(Display, AcesRisesFromBlackToWhite) {
  // (x (2.51 x + 0.03)) / (x (2.43 x + 0.59) + 0.14) at 0.18 and 1.
  EXPECT_NEAR(displayed(Rgb::Constant(0.18f), {0.0, Tonemap::kAces})[0], 0.2669f, 1e-3f);
  EXPECT_NEAR(displayed(Rgb::Ones(), {0.0, Tonemap::kAces})[1], 2.54f / 3.16f, 1e-5f);
  float before = -1.0f;
  for (float v = 0.0f; v < 100.0f; v = 1.5f * v + 0.001f) {
    const float shown = displayed(Rgb::Constant(v), {0.0, Tonemap::kAces})[2];
    EXPECT_GT(shown, before);
    before = shown;
  }
}

TEST(Display, PicturesEndAtOneAndKeepWhatIsNoNumber) {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::nanf("");
  Image image(3, 1, {"B", "G", "R"});
  image.pixels = {-1.0f, 0.5f, 7.0f, infinity, 0.0f, -infinity, nan, 0.25f, 0.5f};
  for (const Tonemap tonemap : {Tonemap::kNone, Tonemap::kReinhard, Tonemap::kAces}) {
    const Image shown = displayed(image, {0.0, tonemap});
    EXPECT_GT(shown.pixel(0, 0)[0], shown.pixel(0, 0)[1]);
    EXPECT_EQ(shown.pixel(0, 0)[2], 0.0f);
    EXPECT_EQ(shown.pixel(1, 0)[2], 1.0f);
    EXPECT_EQ(shown.pixel(1, 0)[0], 0.0f);
    EXPECT_TRUE(std::isnan(shown.pixel(2, 0)[2]));
  }
}

}  // namespace
}  // namespace vrc
