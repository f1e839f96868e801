// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/version.h"
#include "io/color.h"
#include "io/image_io.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using test::run_vrc;
using testing::HasSubstr;

constexpr const char* kMethods[] = {"analytic", "no-glossy-glossy", "sh", "finite-differences"};

/// A folder for the files of small runs.
class DerivativesCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  /// With as few rays as there can be, of each kind.
  [[nodiscard]] test::ProgramResult derive(const std::string& scene, const std::string& prefix,
                                           std::initializer_list<std::string> extra = {},
                                           const char* rays = "1024", const char* order = "4") const {
    std::vector<std::string> arguments{"derivatives", scene,        "-o",   at(prefix),
                                       "--quiet",     "--size",     "12x9", "--gather-rays",
                                       rays,          "--sh-order", order};
    arguments.insert(arguments.end(), extra);
    return run_vrc(arguments);
  }
  [[nodiscard]] nlohmann::json json(const std::string& prefix) const {
    return nlohmann::json::parse(test::read_file(at(prefix + ".json")));
  }

  test::TempDir folder_;
  std::string scene_ = test::write_test_scene(folder_.path()).string();
};

TEST_F(DerivativesCommand, HelpListsItsOptionsAndMethods) {
  const auto help = run_vrc({"derivatives", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* text :
       {"-o,--output", "--gather-rays", "--reference-rays", "--sh-order", "--step", "--size", "--crop",
        "--seed", "-D,--define", "--threads", "--quiet", "--bounces", "--exposure", "99th percentile",
        "analytic", "no-glossy-glossy", "finite-differences", "Examples:"}) {
    EXPECT_THAT(help.out, HasSubstr(text));
  }
  EXPECT_THAT(run_vrc({"--help"}).out, HasSubstr("vrc derivatives"));
}

TEST_F(DerivativesCommand, WritesPicturesOfEveryMethodAndTheReport) {
  const auto result = derive(scene_, "a");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("no-glossy-glossy"));
  const auto report = json("a");
  EXPECT_EQ(report.at("version"), kVersion);
  EXPECT_EQ(report.at("scene"), scene_);
  EXPECT_EQ(report.at("width"), 12);
  EXPECT_EQ(report.at("gather_rays"), 1024);
  EXPECT_EQ(report.at("reference_rays"), 4096);
  EXPECT_EQ(report.at("sh_order"), 4);
  EXPECT_GT(report.at("step"), 0.0);
  EXPECT_GT(report.at("valid_pixels"), 20);
  EXPECT_LE(report.at("valid_pixels"), 108);
  for (const std::string method : kMethods) {
    for (const std::string quantity : {"gradient", "hessian"}) {
      const Image exr = read_image(at("a_" + method + "_" + quantity + ".exr"));
      EXPECT_EQ(exr.width, 12);
      EXPECT_EQ(exr.height, 9);
      EXPECT_THAT(exr.channels, testing::ElementsAre("R", "G", "B"));
      for (const float v : exr.pixels) EXPECT_TRUE(std::isfinite(v));
      EXPECT_GT(*std::max_element(exr.pixels.begin(), exr.pixels.end()), 0.0f);
      EXPECT_LT(*std::min_element(exr.pixels.begin(), exr.pixels.end()), 0.0f);
      EXPECT_EQ(read_image(at("a_" + method + "_" + quantity + ".png")).height, 9);
    }
    const auto& summary = report.at("methods").at(method);
    EXPECT_GT(summary.at("cpu_seconds_per_record"), 0.0);
    EXPECT_GE(summary.at("hessian").at("median_relative"), 0.0);
  }
  EXPECT_EQ(report.at("methods").at("analytic").at("cost_ratio"), 1.0);
  EXPECT_GT(report.at("methods").at("finite-differences").at("cost_ratio"), 4.0);
  EXPECT_EQ(report.at("methods").at("finite-differences").at("gradient").at("relative_rms"), 0.0);
}

TEST_F(DerivativesCommand, ShowsZeroAsMidGrey) {
  ASSERT_EQ(derive(scene_, "a", {"--crop", "4,5,8,9"}).exit_code, 0);
  const Image exr = read_image(at("a_analytic_gradient.exr")),
              png = read_image(at("a_analytic_gradient.png"));
  EXPECT_EQ(exr.pixel(0, 0)[0], 0.0f);
  EXPECT_NEAR(srgb_from_linear(png.pixel(0, 0)[0]), 0.5f, 0.003f);
  const double scale = json("a").at("gradient_scale");
  for (std::size_t i = 0; i < exr.pixels.size(); ++i) {
    const double share = std::clamp(static_cast<double>(exr.pixels[i]) / scale, -1.0, 1.0);
    EXPECT_NEAR(srgb_from_linear(png.pixels[i]), 0.5 + 0.5 * share, 0.003);
  }
}

TEST_F(DerivativesCommand, FindsThatTheGlossyGlossyTermMatters) {
  const auto result = derive(VRC_SOURCE_DIR "/scenes/glossy_pair.xml", "a", {}, "4096", "10");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto methods = json("a").at("methods");
  const auto error = [&](const char* method, const char* quantity) {
    return methods.at(method).at(quantity).at("relative_rms").get<double>();
  };
  EXPECT_LT(error("analytic", "gradient"), 0.1);
  EXPECT_LT(error("analytic", "hessian"), 0.3);
  EXPECT_GT(error("no-glossy-glossy", "gradient"), 3.0 * error("analytic", "gradient"));
  EXPECT_GT(error("no-glossy-glossy", "hessian"), 2.0 * error("analytic", "hessian"));
  EXPECT_GT(error("sh", "gradient"), 2.0 * error("analytic", "gradient"));  // exponent 100 rings
}

TEST_F(DerivativesCommand, GivesTheSamePicturesAtAnyNumberOfThreads) {
  for (const char* threads : {"1", "2"})
    ASSERT_EQ(derive(scene_, threads, {"--threads", threads, "--seed", "3"}).exit_code, 0);
  for (const std::string method : kMethods) {
    for (const std::string end : {"_gradient.exr", "_gradient.png", "_hessian.exr", "_hessian.png"}) {
      EXPECT_EQ(test::read_file(at("1_" + method + end)), test::read_file(at("2_" + method + end)))
          << method << end;
    }
  }
}

TEST_F(DerivativesCommand, RefusesBadUsage) {
  const auto expect_refused = [](const test::ProgramResult& result, const char* message) {
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  expect_refused(run_vrc({"derivatives", scene_}), "--output is required");
  expect_refused(run_vrc({"derivatives", "-o", at("a")}), "scene is required");
  expect_refused(derive(at("none.xml"), "a"), "no such file");
  expect_refused(derive(scene_, "missing/a"), "missing");
  expect_refused(derive(scene_, "a", {"--bounces", "0"}), "give --bounces 1 or more");
  expect_refused(derive(scene_, "a", {"--crop", "0,0,99,9"}), "reaches outside the film of 12x9");
  expect_refused(derive(scene_, "a", {}, "1024", "99"), "a whole number from 1 to 31");
  expect_refused(derive(scene_, "a", {"--step", "0"}), "--step");
  EXPECT_FALSE(fs::exists(at("a.json")));
}

TEST_F(DerivativesCommand, WritesNothingWhenInterrupted) {
  test::Program program({"derivatives", scene_, "-o", at("a"), "--size", "512x512"});
  ASSERT_TRUE(program.wait_for_error_text("derivatives\n"));
  program.send(SIGINT);
  EXPECT_EQ(program.finish().exit_code, 130);
  EXPECT_FALSE(fs::exists(at("a.json")));
}

}  // namespace
}  // namespace vrc
