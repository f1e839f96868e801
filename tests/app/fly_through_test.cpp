// SPDX-License-Identifier: GPL-3.0-or-later
// `vrc render` with cameras, curvature and representations of its own choice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "exported_ply.h"
#include "io/image_io.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

using test::run_vrc;
using testing::HasSubstr;

class FlyThrough : public testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] test::ProgramResult run(const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments{"render", scene_,          "--spp", "2",          "--quiet", "--error",
                                       "0.3",    "--gather-rays", "1024",  "--sh-order", "6"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_vrc(arguments);
  }

  test::TempDir folder_;
  std::string scene_ = test::write_test_scene(folder_.path()).string();
  std::string path_ = test::write_file(folder_ / "path.txt",
                                       "# three frames\n0 1 4  0 0.5 0\n0.05 1 4  0 0.5 0\n"
                                       "0.1 1 4  0 0.5 0  0 1 0\n")
                          .string();
};

TEST_F(FlyThrough, WritesEveryFrameFromACacheThatGrows) {
  const auto result = run({"-o", at("a.exr"), "-o", at("a.png"), "--strategy", "view-independent",
                           "--camera-path", path_, "--stats", at("a.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out,
              testing::AllOf(HasSubstr("frame 0: "), HasSubstr("frame 2: "), HasSubstr("records made")));
  const auto frames = nlohmann::json::parse(test::read_file(at("a.json"))).at("frames");
  ASSERT_EQ(frames.size(), 3u);
  std::uint64_t records = 0;
  for (const auto& frame : frames) {
    records += frame.at("records_made").get<std::uint64_t>();
    EXPECT_EQ(frame.at("records"), records);
    EXPECT_EQ(frame.at("records_of_sh"), records);
    EXPECT_EQ(frame.at("records_of_sh_by_reason").at("always"), records);
  }
  EXPECT_LT(2 * frames[1].at("records_made").get<int>(), frames[0].at("records_made").get<int>());
  EXPECT_NE(read_image(at("a_0000.exr")).pixels, read_image(at("a_0002.exr")).pixels);
  EXPECT_EQ(read_image(at("a_0001.png")).width, 32);
}

TEST_F(FlyThrough, IsTheSameAtAnyNumberOfThreads) {
  for (const char* threads : {"1", "2"}) {
    ASSERT_EQ(run({"-o", at(std::string(threads) + ".exr"), "--strategy", "view-independent-outgoing",
                   "--camera-path", path_, "--threads", threads})
                  .exit_code,
              0);
  }
  EXPECT_EQ(read_image(at("1_0002.exr")).pixels, read_image(at("2_0002.exr")).pixels);
}

TEST_F(FlyThrough, ExplainsWhatItCannotDo) {
  const auto expect_error = [&](const std::vector<std::string>& extra, const std::string& text) {
    std::vector<std::string> arguments{"-o", at("a.exr")};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(text));
  };
  expect_error({"--camera-path", path_}, "--strategy view-independent");
  expect_error({"--camera-path", path_, "--strategy", "view-independent", "--representation", "analytic"},
               "serve any camera");
  expect_error({"--camera-path", path_, "--strategy", "view-independent", "--record-map", at("m.ply")},
               "leave out record maps");
  expect_error({"--camera-path", at("none.txt"), "--strategy", "view-independent"}, "none.txt");
  expect_error({"--baseline", "ward"}, "glossy");
  expect_error({"--baseline", "ward", "--representation", "sh"}, "--baseline");
}

TEST_F(FlyThrough, RecordsOfHarmonicsAreCountedAndMarked) {
  const auto result = run({"-o", at("a.exr"), "--representation", "sh", "--record-map", at("m.ply")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const test::ExportedPly map = test::read_exported_ply(at("m.ply"));
  ASSERT_FALSE(map.vertices.empty());
  for (const auto& v : map.vertices) {
    EXPECT_EQ(v.at("is_sh"), 1);
    EXPECT_EQ(v.at("sh_reason"), 1);
    EXPECT_GT(v.at("L_r"), 0);
  }
  EXPECT_THAT(result.out, HasSubstr(fmt::format("{} records ({} of spherical", map.vertices.size(),
                                                map.vertices.size())));
}

TEST_F(FlyThrough, ABentSheetIsOneRegionOrTwoByTheCreaseAngle) {
  // Two quads that meet at 30 degrees, below a camera.
  const std::string roof =
      test::write_file(folder_ / "roof.obj",
                       "v -1 0 -1\nv 0 0.2679 -1\nv 1 0 -1\nv -1 0 1\nv 0 0.2679 1\nv 1 0 1\n"
                       "f 1 4 5 2\nf 2 5 6 3\n")
          .string();
  const auto regions = [&](const std::string& angle) {
    const auto result = run_vrc({"records", roof, "-o", at("m.ply"), "--crease-angle", angle, "--curvature",
                                 "jet", "--size", "48x48", "--records", "60", "--camera-origin", "0,3,1",
                                 "--camera-target", "0,0,0", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::set<double> found;
    for (const auto& v : test::read_exported_ply(at("m.ply")).vertices) found.insert(v.at("region"));
    return found.size();
  };
  EXPECT_EQ(regions("20"), 2u);
  EXPECT_EQ(regions("40"), 1u);
}

}  // namespace
}  // namespace vrc
