// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "app/version.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

using test::run_vrc;
using testing::HasSubstr;

TEST(CommandLine, VersionIsThatOfTheProject) {
  const auto result = run_vrc({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "vrc " + std::string(kVersion) + "\n");
  EXPECT_THAT(test::read_file(VRC_SOURCE_DIR "/CMakeLists.txt"),
              HasSubstr("project(vrc VERSION " + std::string(kVersion) + " "));
}

TEST(CommandLine, ProgramExitsWithTheCodeOfItsEntry) {
  const auto result = run_vrc({"render", "none.xml", "--spp", "0", "-o", "none.exr"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("vrc: error: --spp: '0' is not"));
}

TEST(CommandLine, HelpNamesEveryCommandAndGivesAnExample) {
  const auto result = run_vrc({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, testing::AllOf(HasSubstr("render"), HasSubstr("compare"), HasSubstr("Examples:")));
  for (const char* command : {"render", "records", "compare"}) {
    const auto help = run_vrc({command, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.out, testing::AllOf(HasSubstr("Examples:"), HasSubstr(std::string("vrc ") + command)));
    EXPECT_TRUE(help.err.empty());
  }
}

TEST(CommandLine, RenderHelpListsEveryOption) {
  const std::string help = run_vrc({"render", "--help"}).out;
  for (const char* option : {"-o,--output",
                             "--method",
                             "--only",
                             "--bounces",
                             "--size",
                             "--spp",
                             "--seed",
                             "--threads",
                             "--error",
                             "--records",
                             "--gather-rays",
                             "--taylor-order",
                             "--no-glossy-glossy",
                             "--occlusion",
                             "--flat-derivatives",
                             "--placement",
                             "--max-normal-deviation",
                             "--record-map",
                             "--record-ellipses",
                             "--record-overlay",
                             "--stats",
                             "--reference",
                             "--crop",
                             "--aovs",
                             "--exposure",
                             "--quiet",
                             "-D,--define",
                             "--lenient",
                             "--camera-origin",
                             "--camera-target",
                             "--fov",
                             "--light-samples"}) {
    EXPECT_THAT(help, HasSubstr(option));
  }
}

struct UsageError {
  std::vector<std::string> arguments;  ///< "%" stands for the test's folder, which holds scene.xml.
  std::string message;
};

void replace_percent(std::string& text, const std::string& by) {
  if (const auto at = text.find('%'); at != std::string::npos) text.replace(at, 1, by);
}

/// Runs the program's entry inside the test; starting the program costs a quarter of a second.
test::ProgramResult run_inside(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "vrc");
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(static_cast<int>(argv.size()), argv.data());
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

/// Each ends with exit code 2 and one line, and writes nothing.
void expect_refused(std::initializer_list<UsageError> cases) {
  const test::TempDir folder;
  static_cast<void>(test::write_test_scene(folder.path()));
  for (UsageError usage : cases) {
    for (std::string& argument : usage.arguments) replace_percent(argument, folder.path().string());
    SCOPED_TRACE(testing::PrintToString(usage.arguments));
    const auto result = run_inside(usage.arguments);
    EXPECT_EQ(result.exit_code, kExitBadInput) << result.err;
    EXPECT_TRUE(result.out.empty()) << result.out;
    EXPECT_THAT(result.err, HasSubstr(usage.message));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
        << "left a file behind";
  }
}

std::vector<std::string> render_with(std::initializer_list<std::string> extra) {
  std::vector<std::string> arguments{"render", "%/scene.xml", "-o", "%/out.exr"};
  arguments.insert(arguments.end(), extra);
  return arguments;
}

TEST(CommandLineErrors, OfUsage) {
  expect_refused({UsageError{{}, "give a command: render or compare"}, UsageError{{"paint"}, "paint"},
                  UsageError{{"--verbose"}, "--verbose"}, UsageError{{"render"}, "scene is required"},
                  UsageError{{"render", "%/scene.xml"}, "--output is required"},
                  UsageError{{"render", "%/scene.xml", "-o"}, "--output"},
                  UsageError{{"render", "%/scene.xml", "%/other.xml", "-o", "%/out.exr"}, "other.xml"},
                  UsageError{{"compare", "a.exr"}, "reference is required"},
                  UsageError{{"compare", "a.exr", "b.exr", "--block", "0"}, "whole number from 1 to 16384"},
                  UsageError{render_with({"--wrong"}), "--wrong"},
                  UsageError{render_with({"--spp"}), "--spp"},
                  UsageError{render_with({"--spp", "1", "--spp", "2"}), "--spp"}});
}

TEST(CommandLineErrors, OfNumbers) {
  expect_refused(
      {UsageError{render_with({"--spp", "0"}), "--spp: '0' is not a whole number from 1 to 1048576"},
       UsageError{render_with({"--spp", "four"}), "'four' is not a whole number"},
       UsageError{render_with({"--spp", "1.5"}), "'1.5' is not a whole number"},
       UsageError{render_with({"--spp", "99999999999999999999"}), "is not a whole number"},
       UsageError{render_with({"--seed", "-1"}), "'-1' is not a whole number from 0"},
       UsageError{render_with({"--bounces", "-2"}), "--bounces: '-2' is not a whole number from -1"},
       UsageError{render_with({"--threads", "0"}), "--threads"},
       UsageError{render_with({"--error", "0"}), "--error: '0' is not a number from"},
       UsageError{render_with({"--error", "nan"}), "'nan' is not a number"},
       UsageError{render_with({"--error", "inf"}), "'inf' is not a number"},
       UsageError{render_with({"--error", "-0.1"}), "--error"},
       UsageError{render_with({"--records", "0"}), "--records"},
       UsageError{render_with({"--records", "100", "--error", "0.1"}), "--records"},
       UsageError{render_with({"--gather-rays", "0"}), "--gather-rays"},
       UsageError{render_with({"--taylor-order", "3"}), "whole number from 0 to 2"},
       UsageError{render_with({"--max-normal-deviation", "3.2"}), "--max-normal-deviation"},
       UsageError{render_with({"--light-samples", "-1"}), "--light-samples"},
       UsageError{render_with({"--exposure", "1e9"}), "--exposure"},
       UsageError{render_with({"--fov", "180"}), "--fov"}});
}

TEST(CommandLineErrors, OfWords) {
  expect_refused({UsageError{render_with({"--method", "magic"}), "'magic' is not one of cache|path|direct"},
                  UsageError{render_with({"--only", "some"}), "full|direct|indirect"},
                  UsageError{render_with({"--placement", "random"}), "hessian|uniform"},
                  UsageError{render_with({"--size", "640"}), "--size: '640' is not a size such as 640x480"},
                  UsageError{render_with({"--size", "0x480"}), "--size"},
                  UsageError{render_with({"--size", "640x99999"}), "at most 16384x16384"},
                  UsageError{render_with({"--size", "640x480x3"}), "--size"},
                  UsageError{render_with({"--crop", "0,0,8"}), "--crop"},
                  UsageError{render_with({"--crop", "8,0,8,8"}), "0 <= x0 < x1"},
                  UsageError{render_with({"--crop", "0,0,33,8"}), "outside the film of 32x24"},
                  UsageError{render_with({"--camera-origin", "1,2"}), "three numbers x,y,z"},
                  UsageError{render_with({"--camera-target", "1,2,nan"}), "three numbers x,y,z"},
                  UsageError{render_with({"--camera-origin", "1,2,3"}), "for bare meshes"},
                  UsageError{render_with({"-D", "floor"}), "NAME=VALUE"},
                  UsageError{render_with({"-D", "=1"}), "NAME=VALUE"}});
}

TEST(CommandLineErrors, OfFiles) {
  expect_refused(
      {UsageError{{"render", "%/none.xml", "-o", "%/out.exr"}, "none.xml: no such file"},
       UsageError{{"render", "%/scene.xml", "-o", "%/out.jpg"}, "written as .exr or .png"},
       UsageError{{"render", "%/scene.xml", "-o", "%/out"}, "written as .exr or .png"},
       UsageError{{"render", "%/scene.xml", "-o", "%/no/out.exr"}, "does not exist; create it first"},
       UsageError{render_with({"-o", "%/out.exr"}), "named for two outputs"},
       UsageError{render_with({"--stats", "%/../out/"}), "names no file"},
       UsageError{render_with({"--stats", "%/scene.xml"}), "is an input of this command"},
       UsageError{render_with({"--path-rays", "512"}), "--path-rays needs --method path"},
       UsageError{render_with({"--path-rays", "16", "--method", "path"}), "--path-rays"},
       UsageError{render_with({"--record-map", "%/no/map.ply"}), "does not exist"},
       UsageError{render_with({"--record-map", "%/map.ply", "--method", "path"}), "need --method cache"},
       UsageError{render_with({"--record-map", "%/map.xyz"}), "written as .ply, .vtp or .csv"},
       UsageError{render_with({"--record-ellipses", "%/map.csv"}), "written as .ply or .vtp"},
       UsageError{render_with({"--record-overlay", "%/map.exr"}), "written as .png"},
       UsageError{render_with({"--record-overlay", "%/o.png", "--method", "path"}), "need --method cache"},
       UsageError{render_with({"--record-map", "%/a.ply", "--record-ellipses", "%/a.ply"}),
                  "named for two outputs"},
       UsageError{{"records", "%/scene.xml"}, "give a file to write"},
       UsageError{{"records", "%/none.xml", "-o", "%/a.ply"}, "none.xml: no such file"},
       UsageError{{"records", "%/scene.xml", "-o", "%/a.exr"},
                  "record maps are written as .ply, .vtp or .csv"},
       UsageError{{"records", "%/scene.xml", "-o", "%/no/a.csv"}, "does not exist"},
       UsageError{{"records", "%/scene.xml", "-o", "%/a.ply", "--ellipses", "%/a.csv"}, ".ply or .vtp"},
       UsageError{{"records", "%/scene.xml", "--overlay", "%/a.ply"}, "overlays are written as .png"},
       UsageError{{"records", "%/scene.xml", "-o", "%/a.ply", "--overlay", "%/a.ply"}, "written as .png"},
       UsageError{{"records", "%/scene.xml", "-o", "%/a.ply", "--method", "path"}, "--method"},
       UsageError{render_with({"--reference", "%/none.exr"}), "none.exr: no such file"},
       UsageError{render_with({"--reference", "%/scene.xml"}), "cannot be read as an image"},
       UsageError{{"compare", "%/none.exr", "%/none.exr"}, "none.exr: no such file"},
       UsageError{{"compare", "%/scene.xml", "%/scene.xml"}, "cannot be read as an image"}});
}

}  // namespace
}  // namespace vrc
