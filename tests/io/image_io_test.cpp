// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/image_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/color.h"
#include "support.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The 8-bit values that a PNG holds.
std::vector<int> png_bytes(const fs::path& path) {
  std::vector<int> bytes;
  for (const float value : read_image(path).pixels) {
    bytes.push_back(static_cast<int>(std::lround(srgb_from_linear(value) * 255.0f)));
  }
  return bytes;
}

Image layered_image() {
  Image image(7, 3,
              {"R", "G", "B", "direct.R", "direct.G", "direct.B", "indirect.R", "indirect.G", "indirect.B",
               "albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "depth.Z"});
  test::SeededBits bits(5);
  for (float& v : image.pixels) v = static_cast<float>(std::ldexp(bits.uniform() - 0.3, 20));
  return image;
}

float value_of(const Image& image, int x, int y, const std::string& channel) {
  const auto found = std::find(image.channels.begin(), image.channels.end(), channel);
  if (found == image.channels.end()) throw std::runtime_error("no channel " + channel);
  return image.pixel(x, y)[found - image.channels.begin()];
}

TEST(WriteExr, KeepsEveryFloatUnderItsName) {
  const test::TempDir folder;
  const Image image = layered_image();
  write_exr(folder / "a.exr", image);
  const Image read = read_image(folder / "a.exr");
  ASSERT_EQ(read.width, image.width);
  ASSERT_EQ(read.height, image.height);
  EXPECT_THAT(read.channels, testing::UnorderedElementsAreArray(image.channels));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (const std::string& name : image.channels) {
        ASSERT_EQ(value_of(read, x, y, name), value_of(image, x, y, name)) << name;
      }
    }
  }
}

TEST(WriteExr, ReadersFindRedGreenBlueFirst) {
  const test::TempDir folder;
  write_exr(folder / "a.exr", layered_image());
  const Image read = read_image(folder / "a.exr");
  ASSERT_GE(read.channels.size(), 3u);
  EXPECT_THAT(std::vector<std::string>(read.channels.begin(), read.channels.begin() + 3),
              testing::ElementsAre("R", "G", "B"));
}

TEST(WriteExr, KeepsNonFiniteAndVeryLargeValues) {
  const test::TempDir folder;
  Image image(4, 1, {"R", "G", "B"});
  image.pixels = {kNan, kInfinity, -kInfinity, 1e30f, 1e-30f, 70000.0f, 0.0f, -1.0f, 1.0f, 2.0f, 3.0f, 4.0f};
  write_exr(folder / "a.exr", image);
  const Image read = read_image(folder / "a.exr");
  EXPECT_TRUE(std::isnan(read.pixels[0]));
  for (std::size_t i = 1; i < image.pixels.size(); ++i) EXPECT_EQ(read.pixels[i], image.pixels[i]);
}

TEST(WriteExr, HoldsTheMetadataAndNoTimeOfDay) {
  const test::TempDir folder;
  write_exr(folder / "a.exr", layered_image(), {{"vrc:scene", "box.xml"}, {"vrc:unfinished", "true"}});
  const std::string bytes = test::read_file(folder / "a.exr");
  EXPECT_THAT(bytes, testing::HasSubstr("vrc:scene"));
  EXPECT_THAT(bytes, testing::HasSubstr("box.xml"));
  EXPECT_THAT(bytes, testing::HasSubstr("vrc:unfinished"));
  // The library stamps "YYYY:MM:DD HH:MM:SS" unless it is told not to.
  EXPECT_THAT(bytes, testing::Not(testing::ContainsRegex("20[0-9][0-9]:[0-9][0-9]:[0-9][0-9]")));
}

TEST(WritePng, AppliesExposureAndTheSrgbCurveOnce) {
  const test::TempDir folder;
  Image image(4, 1, {"R", "G", "B"});
  image.pixels = {0.0f, 0.0f, 0.0f, 0.5f, 0.25f, 0.002f, 1.0f, 2.0f, -1.0f, 0.18f, 0.18f, 0.18f};
  write_png(folder / "a.png", image);
  // From the definition: 0.5 -> 0.7354, 0.25 -> 0.5371, 0.002 -> 0.02584, 0.18 -> 0.4614.
  EXPECT_THAT(png_bytes(folder / "a.png"),
              testing::ElementsAre(0, 0, 0, 188, 137, 7, 255, 255, 0, 118, 118, 118));
  write_png(folder / "b.png", image, {-1.0, Tonemap::kNone});
  // 0.09 -> 0.3316, 0.125 -> 0.3886, 0.001 -> 0.01292.
  EXPECT_THAT(png_bytes(folder / "b.png"),
              testing::ElementsAre(0, 0, 0, 137, 99, 3, 188, 255, 0, 85, 85, 85));
}

TEST(WritePng, ShowsNanInMagentaAndClampsInfinity) {
  const test::TempDir folder;
  Image image(3, 1, {"R", "G", "B"});
  image.pixels = {0.2f, kNan, 0.2f, kInfinity, 0.0f, -kInfinity, 0.0f, 0.0f, 0.0f};
  write_png(folder / "a.png", image);
  EXPECT_THAT(png_bytes(folder / "a.png"), testing::ElementsAre(255, 0, 255, 255, 0, 0, 0, 0, 0));
}

TEST(WritePng, PicksRgbAmongLayersAndSpreadsAGreyImage) {
  const test::TempDir folder;
  Image layers(1, 1, {"N.X", "B", "G", "R"});
  layers.pixels = {0.9f, 0.0f, 0.5f, 1.0f};
  write_png(folder / "a.png", layers);
  EXPECT_THAT(png_bytes(folder / "a.png"), testing::ElementsAre(255, 188, 0));
  Image grey(1, 1, {"error"});
  grey.pixels = {0.5f};
  write_png(folder / "b.png", grey);
  EXPECT_THAT(png_bytes(folder / "b.png"), testing::ElementsAre(188, 188, 188));
}

TEST(WriteImage, SameBytesEveryTime) {
  const test::TempDir folder;
  for (const char* name : {"a", "b"}) {
    write_exr(folder / (std::string(name) + ".exr"), layered_image());
    write_png(folder / (std::string(name) + ".png"), layered_image());
  }
  EXPECT_EQ(test::read_file(folder / "a.exr"), test::read_file(folder / "b.exr"));
  EXPECT_EQ(test::read_file(folder / "a.png"), test::read_file(folder / "b.png"));
}

TEST(WriteImage, BadPathsAreInputErrorsAndLeaveNothing) {
  const test::TempDir folder;
  const Image image = layered_image();
  EXPECT_THROW(write_exr(folder / "missing" / "a.exr", image), InputError);
  EXPECT_THROW(write_png(folder.path(), image), InputError);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ReadImage, NamesTheFileThatItCannotRead) {
  const test::TempDir folder;
  const fs::path text = test::write_file(folder / "a.exr", "this is no picture");
  write_exr(folder / "whole.exr", layered_image());
  const std::string whole = test::read_file(folder / "whole.exr");
  const fs::path half = test::write_file(folder / "half.exr", whole.substr(0, whole.size() / 2));
  for (const fs::path& path : {folder / "none.exr", text, half, folder.path()}) {
    try {
      static_cast<void>(read_image(path));
      FAIL() << path << " was read";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(path.string()));
    }
  }
}

TEST(Color, SrgbCurvesInvertEachOther) {
  for (int i = 0; i <= 255; ++i) {
    const float encoded = static_cast<float>(i) / 255.0f;
    EXPECT_EQ(quantize8(srgb_from_linear(linear_from_srgb(encoded))), i);
  }
  EXPECT_EQ(quantize8(kNan), 0);
}

TEST(Color, MapGetsLighterAllTheWay) {
  double previous = -1.0;
  for (int i = 0; i <= 100; ++i) {
    const Rgb color = map_color(i / 100.0);
    const double light = static_cast<double>(luminance(color));
    EXPECT_GT(light, previous) << i;
    EXPECT_TRUE((color >= 0.0f).all() && (color <= 1.0f).all());
    previous = light;
  }
  EXPECT_EQ(map_color8(-5.0), map_color8(0.0));
  EXPECT_EQ(map_color8(5.0), map_color8(1.0));
}

}  // namespace
}  // namespace vrc
