// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "exported_ply.h"
#include "io/image_io.h"
#include "run_program.h"
#include "support.h"
#include "transport/camera.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using test::run_vrc;
using testing::HasSubstr;

/// A folder with the scene of the tests, and quick placings of its records.
class RecordsCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::vector<std::string> command(const std::string& name,
                                                 std::initializer_list<std::string> extra) const {
    std::vector<std::string> arguments{name,  scene_,          "--spp", "2",      "--error",
                                       "0.3", "--gather-rays", "256",   "--quiet"};
    arguments.insert(arguments.end(), extra);
    return arguments;
  }

  test::TempDir folder_;
  std::string scene_ = test::write_test_scene(folder_.path()).string();
};

TEST_F(RecordsCommand, HelpListsItsOutputsAndTheOptionsOfTheCache) {
  const auto help = run_vrc({"records", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option : {"-o,--output", "--ellipses", "--overlay", "--stats", "--exposure", "--error",
                             "--records", "--sampler", "--size", "--seed", "-D,--define", "--bounces",
                             "--threads", "--quiet", "Examples:", "needs_sh", "px py"}) {
    EXPECT_THAT(help.out, HasSubstr(option));
  }
  EXPECT_THAT(help.out, testing::Not(HasSubstr("--method")));
  EXPECT_THAT(run_vrc({"--help"}).out, HasSubstr("vrc records"));
}

TEST_F(RecordsCommand, WritesMapsEllipsesAndStatistics) {
  const auto result = run_vrc(command("records", {"-o", at("a.ply"), "-o", at("a.vtp"), "-o", at("a.csv"),
                                                  "--ellipses", at("e.ply"), "--stats", at("a.json")}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("(0 of spherical harmonics)"));

  const test::ExportedPly map = test::read_exported_ply(at("a.ply"));
  const auto json = nlohmann::json::parse(test::read_file(at("a.json")));
  ASSERT_GT(map.vertices.size(), 10u);
  EXPECT_EQ(json.at("records"), map.vertices.size());
  // Boxes are flat: no record of this scene needs spherical harmonics.
  EXPECT_EQ(json.at("records_needing_sh"), 0);
  EXPECT_EQ(json.at("records_of_sh"), 0);
  std::size_t sum = 0;
  for (const auto& [reason, count] : json.at("records_by_curvature").items()) sum += count.get<std::size_t>();
  EXPECT_EQ(sum, map.vertices.size());
  EXPECT_EQ(json.at("records_by_curvature").at("flat"), map.vertices.size());
  for (const auto& v : map.vertices) {
    EXPECT_EQ(v.at("is_sh"), 0);
    EXPECT_GE(v.at("patch"), 0);
    EXPECT_GE(v.at("face"), 0);
    EXPECT_GT(v.at("L_r"), 0);
    EXPECT_GT(v.at("mean_hit"), 0);
    EXPECT_GE(v.at("mean_hit"), v.at("nearest_hit"));
    EXPECT_GT(v.at("clamp_factor"), 0);
    EXPECT_LE(v.at("clamp_factor"), 1);
  }

  const std::string csv = test::read_file(at("a.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + map.vertices.size());
  EXPECT_THAT(csv, testing::StartsWith("x,y,z,nx,ny,nz,red,green,blue,quality,radius,r1,r2,"));
  EXPECT_THAT(test::read_file(at("a.vtp")),
              HasSubstr(fmt::format("NumberOfVerts=\"{}\"", map.vertices.size())));
  const test::ExportedPly ellipses = test::read_exported_ply(at("e.ply"));
  EXPECT_GE(ellipses.triangles.size(), map.vertices.size());
  std::set<double> records;
  for (const auto& v : ellipses.vertices) records.insert(v.at("record"));
  EXPECT_EQ(records.size(), map.vertices.size());
}

TEST_F(RecordsCommand, MapsPlaceRecordsInThePicture) {
  ASSERT_EQ(run_vrc(command("records", {"-o", at("a.ply")})).exit_code, 0);
  const Camera camera = look_at(Vec3(0, 1, 4), Vec3(0, 0.5, 0), Vec3::UnitY(), 45.0, 32, 24);
  const test::ExportedPly map = test::read_exported_ply(at("a.ply"));
  ASSERT_GT(map.vertices.size(), 10u);
  for (const auto& v : map.vertices) {
    const auto vector = [&](const std::string& name) {
      return Vec3(v.at(name + "x"), v.at(name + "y"), v.at(name + "z"));
    };
    const Vec3 position = vector("");
    const Vec2 film(v.at("px"), v.at("py"));
    EXPECT_LT((film - camera.film_position(position)).norm(), 1e-3);
    EXPECT_GT(film.minCoeff(), 0.0);  // records are where the camera sees something
    EXPECT_LT(film.x(), 32.0);
    EXPECT_LT(film.y(), 24.0);
    for (const std::string axis : {"1", "2"}) {
      constexpr double kStep = 1e-3;
      const Vec3 half = kStep * v.at("r" + axis) * vector("e" + axis);
      const Vec2 difference =
          (camera.film_position(position + half) - camera.film_position(position - half)) / (2.0 * kStep);
      const Vec2 given(v.at("p" + axis + "x"), v.at("p" + axis + "y"));
      EXPECT_LT((given - difference).norm(), 2e-3 * (1.0 + difference.norm()));
    }
    EXPECT_GE(v.at("rays"), 256);
  }
}

TEST_F(RecordsCommand, PlacesTheRecordsThatRenderUses) {
  ASSERT_EQ(run_vrc(command("records", {"-o", at("a.ply")})).exit_code, 0);
  ASSERT_EQ(run_vrc(command("render", {"-o", at("b.exr"), "--record-map", at("b.ply"), "--record-ellipses",
                                       at("e.vtp")}))
                .exit_code,
            0);
  EXPECT_EQ(test::read_file(at("a.ply")), test::read_file(at("b.ply")));
  EXPECT_THAT(test::read_file(at("e.vtp")), HasSubstr("Name=\"record\""));
}

TEST_F(RecordsCommand, GivesTheSameFilesAtAnyNumberOfThreads) {
  for (const char* threads : {"1", "2"}) {
    const std::string n = threads;
    const auto result =
        run_vrc(command("records", {"-o", at(n + ".ply"), "-o", at(n + ".csv"), "--ellipses", at(n + ".vtp"),
                                    "--overlay", at(n + ".png"), "--threads", n}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  for (const std::string extension : {".ply", ".csv", ".vtp", ".png"}) {
    EXPECT_EQ(test::read_file(at("1" + extension)), test::read_file(at("2" + extension))) << extension;
  }
}

TEST_F(RecordsCommand, OverlayIsThePictureWithBlueLines) {
  const auto result = run_vrc(command(
      "render", {"-o", at("a.png"), "--record-overlay", at("o.png"), "--size", "96x72", "--exposure", "-1"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Image plain = read_image(at("a.png")), overlay = read_image(at("o.png"));
  ASSERT_EQ(overlay.width, 96);
  ASSERT_EQ(overlay.height, 72);
  std::size_t same = 0, bluer = 0, redder = 0;
  for (std::size_t i = 0; i < plain.pixel_count(); ++i) {
    const float* p = &plain.pixels[i * plain.channels.size()];
    const float* q = &overlay.pixels[i * overlay.channels.size()];
    const float blue = (q[2] - q[0]) - (p[2] - p[0]);
    same += std::equal(p, p + 3, q) ? 1 : 0;
    bluer += blue > 0.1f ? 1 : 0;
    redder += blue < -0.1f ? 1 : 0;
  }
  EXPECT_GT(same, 300u);
  EXPECT_GT(bluer, 300u);
  EXPECT_EQ(redder, 0u);  // nothing bends
  ASSERT_EQ(run_vrc(command("records", {"--overlay", at("r.png"), "--size", "96x72", "--exposure", "-1"}))
                .exit_code,
            0);
  EXPECT_EQ(test::read_file(at("r.png")), test::read_file(at("o.png")));
}

TEST_F(RecordsCommand, RefusesASceneWithoutIndirectLight) {
  const auto result = run_vrc(command("records", {"-o", at("a.ply"), "--bounces", "0"}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("give --bounces 1 or more"));
  EXPECT_FALSE(fs::exists(at("a.ply")));
}

}  // namespace
}  // namespace vrc
