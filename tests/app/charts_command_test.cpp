// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "exported_ply.h"
#include "io/image_io.h"
#include "mesh_files.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

using test::run_vrc;
using testing::ContainsRegex;
using testing::HasSubstr;

class ChartsCommand : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string mesh(const std::string& name, const std::string& text) {
    return test::write_file(folder_ / name, text).string();
  }
  test::TempDir folder_;
};

Vec2 uv_of(const std::map<std::string, double>& vertex) { return {vertex.at("s"), vertex.at("t")}; }

double signed_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
}

TEST_F(ChartsCommand, ACubeHasSixUndistortedCharts) {
  const auto result = run_vrc({"charts", mesh("cube.obj", test::kCubeObj), "-o", file("c.ply")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, ContainsRegex("\ncharts +6\n"));
  EXPECT_THAT(result.out, ContainsRegex("\nflipped faces +0\n"));
  EXPECT_THAT(result.out, ContainsRegex("\nstretch +mean 1.0000, max 1.0000\n"));
  EXPECT_THAT(result.out, ContainsRegex("\n  orthographic +[0-9]+ with [0-9]+ faces\n"));
  const test::ExportedPly ply = test::read_exported_ply(file("c.ply"));
  EXPECT_EQ(ply.vertices.size(), 24u);
  std::set<double> patches;
  for (const auto& face : ply.faces) {
    patches.insert(face.at("patch"));
    EXPECT_NEAR(face.at("stretch"), 1.0, 1e-5);
    EXPECT_NEAR(face.at("area_distortion"), 1.0, 1e-5);
  }
  EXPECT_EQ(patches, (std::set<double>{0, 1, 2, 3, 4, 5}));
}

TEST_F(ChartsCommand, UvLieInTheUnitSquareAndKeepTheirOrientation) {
  const std::string sphere = mesh("sphere.ply", test::sphere_ply(2.0, 12));
  ASSERT_EQ(run_vrc({"charts", sphere, "-o", file("c.ply"), "--color", "stretch"}).exit_code, 0);
  const test::ExportedPly ply = test::read_exported_ply(file("c.ply"));
  ASSERT_EQ(ply.triangles.size(), 12u * 12u * 12u);
  EXPECT_GT(ply.vertices.size(), 6u * 12u * 12u + 2u);  // cut along the charts
  for (const auto& vertex : ply.vertices) {
    EXPECT_GE(uv_of(vertex).minCoeff(), 0.0);
    EXPECT_LE(uv_of(vertex).maxCoeff(), 1.0);
  }
  for (std::size_t f = 0; f < ply.triangles.size(); ++f) {
    const auto& [a, b, c] = ply.triangles[f];
    EXPECT_GT(signed_area(uv_of(ply.vertices[a]), uv_of(ply.vertices[b]), uv_of(ply.vertices[c])), 0.0);
    EXPECT_GE(ply.faces[f].at("stretch"), 1.0 - 1e-6);
  }
}

TEST_F(ChartsCommand, DrawsTheLayout) {
  const std::string cube = mesh("cube.obj", test::kCubeObj);
  ASSERT_EQ(run_vrc({"charts", cube, "-o", file("c.png"), "--size", "120x100"}).exit_code, 0);
  const Image image = read_image(file("c.png"));
  ASSERT_EQ(image.width, 120);
  ASSERT_EQ(image.height, 100);
  std::set<std::array<float, 3>> colors;
  std::size_t white = 0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    const float* rgb = image.pixels.data() + p * image.channels.size();
    colors.insert({rgb[0], rgb[1], rgb[2]});
    white += rgb[0] == 1.0f && rgb[1] == 1.0f && rgb[2] == 1.0f ? 1 : 0;
  }
  EXPECT_GE(colors.size(), 7u);  // six charts and the paper, besides mixed pixels
  EXPECT_GT(white, image.pixel_count() / 20);
  EXPECT_LT(white, image.pixel_count() * 9 / 10);
}

TEST_F(ChartsCommand, FilesDoNotDependOnThreads) {
  const std::string sphere = mesh("sphere.ply", test::sphere_ply(1.0, 10));
  for (const std::string threads : {"1", "2"}) {
    const std::string name = file(threads);
    ASSERT_EQ(run_vrc({"charts", sphere, "-o", name + ".ply", "-o", name + ".png", "--color", "area",
                       "--threads", threads})
                  .exit_code,
              0);
  }
  for (const char* extension : {".ply", ".png"}) {
    EXPECT_EQ(test::read_file(file("1") + extension), test::read_file(file("2") + extension)) << extension;
  }
}

TEST_F(ChartsCommand, RefusesBadInput) {
  const std::string cube = mesh("cube.obj", test::kCubeObj);
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& part) {
    const auto result = run_vrc(arguments);
    EXPECT_EQ(result.exit_code, 2) << part;
    EXPECT_THAT(result.err, HasSubstr(part));
  };
  refused({"charts", cube}, "--output");
  refused({"charts", cube, "-o", file("c.vtp")}, "c.vtp");
  refused({"charts", cube, "-o", file("c.ply"), "--color", "red"}, "red");
  refused({"charts", cube, "-o", file("c.ply"), "--cone-angle", "90"}, "90");
  refused({"charts", file("none.ply"), "-o", file("c.ply")}, "none.ply");
  EXPECT_FALSE(std::filesystem::exists(file("c.ply")));
}

TEST_F(ChartsCommand, ItsHelpShowsAnExample) {
  const auto result = run_vrc({"charts", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* part : {"--color", "--cone-angle", "--crease-angle", "vrc charts bunny.obj -o"}) {
    EXPECT_THAT(result.out, HasSubstr(part));
  }
}

}  // namespace
}  // namespace vrc
