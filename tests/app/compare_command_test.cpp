// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/image_io.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

using test::run_vrc;
using testing::HasSubstr;

class CompareCommand : public testing::Test {
 protected:
  /// Writes an 8x6 picture whose R, G, B and whose layer "indirect" have these values.
  std::string picture(const std::string& name, float value, float layer_value) {
    Image image(8, 6, {"R", "G", "B", "indirect.R", "indirect.G", "indirect.B"});
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = i % 6 < 3 ? value : layer_value;
    write_exr(folder_ / name, image);
    return (folder_ / name).string();
  }
  static nlohmann::json json_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "compare");
    arguments.emplace_back("--json");
    return nlohmann::json::parse(run_vrc(arguments).out);
  }

  test::TempDir folder_;
};

TEST_F(CompareCommand, OfAPictureWithItselfIsZero) {
  const std::string a = picture("a.exr", 0.5f, 0.25f);
  const auto result = run_vrc({"compare", a, a});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, testing::ContainsRegex("relMSE +0\n"));
  const auto json = json_of({a, a, "--block", "4"});
  for (const char* name : {"mse", "rmse", "relmse", "max_abs", "block_relmse"})
    EXPECT_EQ(json.at(name), 0.0) << name;
  EXPECT_EQ(json.at("non_finite"), 0);
  EXPECT_EQ(json.at("mean_ratio"), 1.0);
}

TEST_F(CompareCommand, ShowsBothPicturesAndTheirErrorSideBySide) {
  const std::string a = picture("a.exr", 0.5f, 0.3f), b = picture("b.exr", 0.25f, 0.2f);
  const auto json = json_of({a, b, "--side-by-side", (folder_ / "both.png").string(), "--exposure", "1"});
  EXPECT_GT(json.at("ssim"), 0.0);
  EXPECT_LT(json.at("ssim"), 1.0);
  const double error = 0.25 / std::sqrt(0.25 * 0.25 + 0.01);
  for (const char* share : {"50", "90", "95", "99", "100"})
    EXPECT_NEAR(json.at("relative_error_percentiles").at(share), error, 1e-5) << share;
  const Image both = read_image(folder_ / "both.png");
  EXPECT_EQ(both.width, 24);
  EXPECT_GE(both.height, 6);
  EXPECT_NEAR(both.pixel(3, 3)[0], 1.0f, 0.01f);
  EXPECT_NEAR(both.pixel(11, 3)[0], 0.5f, 0.01f);
  const auto wrong = run_vrc({"compare", a, b, "--side-by-side", (folder_ / "both.exr").string()});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr(".png"));
}

TEST_F(CompareCommand, MeasuresTheLayerItIsAskedFor) {
  const std::string a = picture("a.exr", 0.5f, 0.3f), b = picture("b.exr", 0.5f, 0.2f);
  EXPECT_EQ(json_of({a, b}).at("mse"), 0.0);
  const auto json = json_of({a, b, "--layer", "indirect"});
  EXPECT_NEAR(json.at("mse"), 0.01, 1e-8);
  EXPECT_NEAR(json.at("relmse"), 0.01 / 0.05, 1e-6);
  EXPECT_NEAR(json.at("mean_ratio"), 1.5, 1e-6);
  const auto missing = run_vrc({"compare", a, b, "--layer", "direct"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, testing::AllOf(HasSubstr("a.exr"), HasSubstr("direct.R")));
}

TEST_F(CompareCommand, BlocksAverageTheNoiseAway) {
  Image image(8, 6, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = 0.5f + ((i / 3) % 2 == 0 ? 0.1f : -0.1f);
  write_exr(folder_ / "noisy.exr", image);
  const auto json = json_of({(folder_ / "noisy.exr").string(), picture("b.exr", 0.5f, 0.0f), "--block", "2"});
  EXPECT_NEAR(json.at("mse"), 0.01, 1e-7);
  EXPECT_NEAR(json.at("block_relmse"), 0.0, 1e-12);
}

TEST_F(CompareCommand, UsesTwoHalvesOfAReference) {
  const std::string a = picture("a.exr", 0.5f, 0.0f);
  const std::string low = picture("low.exr", 0.4f, 0.0f), high = picture("high.exr", 0.6f, 0.0f);
  const auto json = json_of({a, low, "--second-half", high, "--block", "3"});
  EXPECT_NEAR(json.at("relmse"), 0.0, 1e-9);  // the mean of the halves is the picture
  EXPECT_NEAR(json.at("two_half_relmse"), -0.01 / 0.26, 1e-6);
  EXPECT_NEAR(json.at("block_two_half_relmse"), -0.01 / 0.26, 1e-6);
}

TEST_F(CompareCommand, CountsWhatIsNotFiniteAndFails) {
  Image image(8, 6, {"R", "G", "B"});
  image.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[7] = std::numeric_limits<float>::infinity();
  write_exr(folder_ / "nan.exr", image);
  const std::string nan = (folder_ / "nan.exr").string(), black = picture("b.exr", 0.0f, 0.0f);
  for (const auto& pair : {std::pair(nan, black), std::pair(black, nan), std::pair(nan, nan)}) {
    const auto result = run_vrc({"compare", pair.first, pair.second});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.out, testing::ContainsRegex("not finite +2\n"));
    EXPECT_EQ(json_of({pair.first, pair.second}).at("non_finite"), 2);
  }
}

TEST_F(CompareCommand, WritesAHeatMap) {
  Image image(8, 6, {"R", "G", "B"});
  image.pixel(3, 2)[0] = image.pixel(3, 2)[1] = image.pixel(3, 2)[2] = 5.0f;
  image.pixel(4, 2)[0] = std::numeric_limits<float>::quiet_NaN();
  write_exr(folder_ / "a.exr", image);
  const std::string map = (folder_ / "map.png").string();
  EXPECT_EQ(run_vrc({"compare", (folder_ / "a.exr").string(), picture("b.exr", 0.0f, 0.0f), "--heatmap", map})
                .exit_code,
            1);
  const Image heat = read_image(map);
  ASSERT_EQ(heat.width, 8);
  ASSERT_EQ(heat.height, 6);
  EXPECT_GT(heat.pixel(3, 2)[1], 10.0f * heat.pixel(0, 0)[1]);  // yellow against violet
  EXPECT_EQ(heat.pixel(4, 2)[0], 1.0f);                         // magenta
  EXPECT_EQ(heat.pixel(4, 2)[1], 0.0f);
  const auto wrong = run_vrc({"compare", map, map, "--heatmap", (folder_ / "map.exr").string()});
  EXPECT_EQ(wrong.exit_code, 2);
}

TEST_F(CompareCommand, RefusesPicturesOfDifferentSizes) {
  write_exr(folder_ / "small.exr", Image(4, 4, {"R", "G", "B"}));
  const auto result = run_vrc({"compare", (folder_ / "small.exr").string(), picture("b.exr", 0.0f, 0.0f)});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("4x4 and 8x6"));
}

}  // namespace
}  // namespace vrc
