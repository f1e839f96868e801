// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/version.h"
#include "io/image_io.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using test::run_vrc;
using testing::HasSubstr;

/// A folder with the scene of the tests, and its quick renderings.
class RenderCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::vector<std::string> render(std::initializer_list<std::string> extra) const {
    std::vector<std::string> arguments{"render",  scene_, "--spp",         "2",
                                       "--error", "0.3",  "--gather-rays", "256"};
    arguments.insert(arguments.end(), extra);
    return arguments;
  }

  test::TempDir folder_;
  std::string scene_ = test::write_test_scene(folder_.path()).string();
};

bool all_finite(const Image& image) {
  return std::all_of(image.pixels.begin(), image.pixels.end(), [](float v) { return std::isfinite(v); });
}

TEST_F(RenderCommand, WritesEveryOutputItWasAskedFor) {
  const auto result =
      run_vrc(render({"-o", at("a.exr"), "-o", at("a.png"), "--stats", at("a.json"), "--record-map",
                      at("a.ply"), "--record-ellipses", at("e.ply"), "--aovs", "--quiet"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out,
              testing::AllOf(HasSubstr(" s, "), HasSubstr("CPU s"), HasSubstr("records"), HasSubstr("rays")));

  const Image image = read_image(at("a.exr"));
  EXPECT_EQ(image.width, 32);
  EXPECT_EQ(image.height, 24);
  EXPECT_TRUE(all_finite(image));
  EXPECT_GT(*std::max_element(image.pixels.begin(), image.pixels.end()), 0.05f);
  EXPECT_THAT(image.channels,
              testing::IsSupersetOf({"R", "G", "B", "direct.R", "indirect.G", "albedo.B", "N.X", "depth.Z"}));
  EXPECT_EQ(read_image(at("a.png")).width, 32);

  const auto json = nlohmann::json::parse(test::read_file(at("a.json")));
  EXPECT_EQ(json.at("version"), kVersion);
  EXPECT_EQ(json.at("scene"), scene_);
  EXPECT_THAT(json.at("command_line").get<std::string>(), HasSubstr("--aovs"));
  EXPECT_EQ(json.at("width"), 32);
  EXPECT_EQ(json.at("spp"), 2);
  EXPECT_EQ(json.at("bounces"), 1);
  EXPECT_EQ(json.at("unfinished"), false);
  EXPECT_FALSE(json.contains("relmse"));
  EXPECT_GT(json.at("records"), 0);
  EXPECT_EQ(json.at("records_needing_sh"), 0);
  EXPECT_EQ(json.at("records_by_curvature").at("flat"), json.at("records"));
  EXPECT_GT(json.at("gather_rays"), 0);
  EXPECT_GT(json.at("peak_memory_bytes"), 1 << 20);
  double phases = 0.0;
  for (const auto& phase : json.at("phases")) phases += phase.at("seconds").get<double>();
  EXPECT_GT(phases, 0.0);
  EXPECT_LE(phases, json.at("seconds").get<double>());

  const std::string vertices = fmt::format("element vertex {}\n", json.at("records").get<int>());
  EXPECT_THAT(test::read_file(at("a.ply")), HasSubstr(vertices));
  EXPECT_THAT(test::read_file(at("e.ply")), HasSubstr("element face"));
}

TEST_F(RenderCommand, SaysHowLargeItsErrorIs) {
  const auto result = run_vrc(render({"-o", at("a.exr"), "--stats", at("a.json")}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("estimated error "));
  const auto json = nlohmann::json::parse(test::read_file(at("a.json")));
  EXPECT_EQ(json.at("accepted_error"), 0.3);
  EXPECT_GT(json.at("relative_error"), 0.0);
  EXPECT_LT(json.at("relative_error"), 1.0);
  EXPECT_GT(json.at("hard_pixels"), 0);
  EXPECT_EQ(json.at("light_samples"), 4);
  EXPECT_THAT(read_image(at("a.exr")).channels, testing::Contains("error.Y"));
}

TEST_F(RenderCommand, ChoosesTheErrorByTheTime) {
  const auto error_within = [&](const char* seconds) {
    const auto result = run_vrc(
        {"render", scene_, "--spp", "2", "-o", at("a.exr"), "--stats", at("a.json"), "--time", seconds});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(test::read_file(at("a.json"))).at("records_error").get<double>();
  };
  EXPECT_LT(error_within("1.5"), error_within("0.01"));
}

TEST_F(RenderCommand, SaysWhenATimeIsNotEnough) {
  const auto hasty =
      run_vrc({"render", scene_, "--spp", "2", "-o", at("a.exr"), "--stats", at("a.json"), "--time", "0.01"});
  EXPECT_EQ(hasty.exit_code, 0);
  EXPECT_THAT(hasty.err, HasSubstr("--time 0.01"));
  const auto json = nlohmann::json::parse(test::read_file(at("a.json")));
  EXPECT_EQ(json.at("light_samples"), 1);
  EXPECT_EQ(json.at("edge_samples"), 2);
  const auto patient = run_vrc({"render", scene_, "--spp", "2", "-o", at("a.exr"), "--time", "3"});
  EXPECT_EQ(patient.exit_code, 0);
  EXPECT_THAT(patient.err, testing::Not(HasSubstr("--time")));
}

TEST_F(RenderCommand, RefusesATimeBesideOtherWaysToSayHowMuch) {
  for (const auto& other :
       {std::array{"--error", "0.1"}, std::array{"--records", "10"}, std::array{"--method", "path"}}) {
    const auto result = run_vrc({"render", scene_, "-o", at("a.exr"), "--time", "5", other[0], other[1]});
    EXPECT_EQ(result.exit_code, 2) << other[0];
    EXPECT_THAT(result.err, testing::AllOf(HasSubstr("--time"), HasSubstr(other[0])));
  }
}

TEST_F(RenderCommand, GivesTheSamePixelsAtAnyNumberOfThreads) {
  ASSERT_EQ(run_vrc(render({"-o", at("a.exr"), "--threads", "1"})).exit_code, 0);
  ASSERT_EQ(run_vrc(render({"-o", at("b.exr"), "--threads", "2"})).exit_code, 0);
  EXPECT_EQ(read_image(at("a.exr")).pixels, read_image(at("b.exr")).pixels);
}

TEST_F(RenderCommand, ComparesWithAReferenceInsideTheCrop) {
  ASSERT_EQ(run_vrc(render({"-o", at("ref.exr"), "--method", "direct"})).exit_code, 0);
  const auto same = run_vrc(render({"-o", at("a.exr"), "--method", "direct", "--crop", "4,6,20,12",
                                    "--reference", at("ref.exr"), "--stats", at("a.json")}));
  ASSERT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr("relMSE 0.000e+00"));
  EXPECT_EQ(nlohmann::json::parse(test::read_file(at("a.json"))).at("relmse"), 0.0);
  const Image image = read_image(at("a.exr"));
  EXPECT_EQ(image.width, 32);
  EXPECT_EQ(image.pixel(0, 0)[0], 0.0f);
  const auto other = run_vrc(render({"-o", at("b.exr"), "--size", "16x16", "--reference", at("ref.exr")}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("is 32x24 pixels and the film 16x16"));
}

TEST_F(RenderCommand, PresetOfThePaperIsItsOptionsSpelledOut) {
  ASSERT_EQ(run_vrc(render({"-o", at("ours.exr")})).exit_code, 0);
  ASSERT_EQ(run_vrc(render({"-o", at("paper.exr"), "--preset", "paper"})).exit_code, 0);
  ASSERT_EQ(run_vrc(render({"-o",
                            at("spelled.exr"),
                            "--flat-derivatives",
                            "--gradient-share",
                            "0",
                            "--dark-share",
                            "0",
                            "--blend-support",
                            "1",
                            "--joint-fit",
                            "off",
                            "--occlusion",
                            "off",
                            "--guided",
                            "off",
                            "--max-normal-deviation",
                            "0.1",
                            "--sh-rule",
                            "paper",
                            "--sh-rays",
                            "uniform",
                            "--supersample-edges",
                            "off",
                            "--hard-pixels",
                            "off",
                            "--error-of",
                            "records"}))
                .exit_code,
            0);
  const auto paper = read_image(at("paper.exr")).pixels;
  EXPECT_NE(paper, read_image(at("ours.exr")).pixels);
  EXPECT_EQ(paper, read_image(at("spelled.exr")).pixels);
}

TEST_F(RenderCommand, SingleOptionsWinOverThePresetWhereverTheyStand) {
  const auto pixels = [&](const char* name, std::initializer_list<std::string> extra) {
    auto arguments = render({"-o", at(name)});
    arguments.insert(arguments.end(), extra);
    const auto result = run_vrc(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_image(at(name)).pixels;
  };
  const auto ours = pixels("ours.exr", {});
  EXPECT_EQ(pixels("default.exr", {"--preset", "default"}), ours);
  const auto before = pixels("before.exr", {"--blend-support", "1.4", "--preset", "paper"});
  EXPECT_EQ(pixels("after.exr", {"--preset", "paper", "--blend-support", "1.4"}), before);
  EXPECT_NE(pixels("paper.exr", {"--preset", "paper"}), before);
  EXPECT_EQ(pixels("undone.exr", {"--total-derivatives",
                                  "--gradient-share",
                                  "1",
                                  "--dark-share",
                                  "0.2",
                                  "--joint-fit",
                                  "on",
                                  "--occlusion",
                                  "on",
                                  "--guided",
                                  "on",
                                  "--preset",
                                  "paper",
                                  "--blend-support",
                                  "1.4",
                                  "--max-normal-deviation",
                                  "0.15",
                                  "--sh-rule",
                                  "auto",
                                  "--sh-rays",
                                  "auto",
                                  "--supersample-edges",
                                  "on",
                                  "--hard-pixels",
                                  "on",
                                  "--error-of",
                                  "picture"}),
            ours);
}

TEST_F(RenderCommand, RefusesUnknownPresets) {
  const auto result = run_vrc(render({"-o", at("a.exr"), "--preset", "ours"}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("default|paper"));
}

TEST_F(RenderCommand, TakesSeveralDefines) {
  const auto run = run_vrc(render({"-o", at("a.exr"), "-D", "first=1", "-D", "second=2"}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("first=1"));
  EXPECT_THAT(run.err, HasSubstr("second=2"));
}

TEST_F(RenderCommand, PassesDefinesToTheScene) {
  ASSERT_EQ(run_vrc(render({"-o", at("a.exr"), "--method", "direct"})).exit_code, 0);
  ASSERT_EQ(run_vrc(render({"-o", at("b.exr"), "--method", "direct", "-D", "floor=0.1"})).exit_code, 0);
  const Image bright = read_image(at("a.exr")), dark = read_image(at("b.exr"));
  EXPECT_GT(bright.pixel(16, 23)[0], 3.0f * dark.pixel(16, 23)[0]);
}

TEST_F(RenderCommand, ShadesWithoutAnOverture) {
  const auto refused = run_vrc(render({"-o", at("a.exr"), "--overture", "off"}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--joint-fit off"));
  for (const char* threads : {"1", "2"}) {
    const auto result = run_vrc(render({"-o", at(threads + std::string(".png")), "--overture", "off",
                                        "--preset", "paper", "--threads", threads}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  EXPECT_EQ(test::read_file(at("1.png")), test::read_file(at("2.png")));
  ASSERT_EQ(run_vrc(render({"-o", at("with.png"), "--preset", "paper"})).exit_code, 0);
  EXPECT_NE(test::read_file(at("1.png")), test::read_file(at("with.png")));
}

TEST_F(RenderCommand, RendersABareMesh) {
  test::write_file(folder_ / "m.obj",
                   "v -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
  const auto result =
      run_vrc({"render", at("m.obj"), "-o", at("m.exr"), "--size", "16x16", "--spp", "1", "--method",
               "direct", "--camera-origin", "0,1,4", "--camera-target", "0,0.3,0", "--fov", "40"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("note: "));
  EXPECT_TRUE(all_finite(read_image(at("m.exr"))));
}

TEST_F(RenderCommand, ReportsSparselyIntoAPipe) {
  const auto result = run_vrc(render({"-o", at("a.exr")}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(std::count(result.err.begin(), result.err.end(), '\n'), 20);
  EXPECT_THAT(result.err, testing::Not(HasSubstr("\r")));
}

class Interruption : public RenderCommand, public testing::WithParamInterface<int> {};

TEST_P(Interruption, WritesWhatThereIsAndSaysSo) {
  test::Program program({"render", scene_, "--method", "path", "--size", "1024x1024", "--spp", "256",
                         "--bounces", "8", "-o", at("a.exr"), "-o", at("a.png"), "--stats", at("a.json")});
  ASSERT_TRUE(program.wait_for_error_text("render\n"));  // the phase has begun and takes long
  program.send(GetParam());
  const auto result = program.finish();
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.err, HasSubstr("interrupted"));
  EXPECT_TRUE(all_finite(read_image(at("a.exr"))));
  const std::string exr = test::read_file(at("a.exr"));
  EXPECT_THAT(exr, HasSubstr("vrc:unfinished"));
  EXPECT_EQ(nlohmann::json::parse(test::read_file(at("a.json"))).at("unfinished"), true);
  EXPECT_TRUE(fs::exists(at("a.png")));
}

INSTANTIATE_TEST_SUITE_P(Signals, Interruption, testing::Values(SIGINT, SIGTERM));

}  // namespace
}  // namespace vrc
