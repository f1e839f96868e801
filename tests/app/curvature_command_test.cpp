// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <pugixml.hpp>

#include "exported_ply.h"
#include "io/image_io.h"
#include "mesh_files.h"
#include "placement/cache_options.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

using test::run_vrc;
using testing::ContainsRegex;
using testing::HasSubstr;

class CurvatureCommand : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string mesh(const std::string& name, const std::string& text) {
    return test::write_file(folder_ / name, text).string();
  }
  std::string sphere() { return mesh("sphere.ply", test::sphere_ply(2.0, 24)); }

  test::TempDir folder_;
};

Vec3 vector_of(const std::map<std::string, double>& vertex, const std::string& stem,
               const std::string& axes = "xyz") {
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) v[static_cast<Eigen::Index>(i)] = vertex.at(stem + axes[i]);
  return v;
}

TEST_F(CurvatureCommand, OfASphereIsItsReciprocalRadius) {
  for (const char* estimator : {"tensor", "jet"}) {
    const auto result = run_vrc({"curvature", sphere(), "-o", file("k.ply"), "--curvature", estimator});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const test::ExportedPly ply = test::read_exported_ply(file("k.ply"));
    ASSERT_EQ(ply.vertices.size(), 6u * 24u * 24u + 2u);
    EXPECT_EQ(ply.faces.size(), 12u * 24u * 24u);
    double k_error = 0.0, gauss_error = 0.0, radius_error = 0.0, frame_error = 0.0;
    for (const auto& vertex : ply.vertices) {
      const auto grow = [](double& error, double value) { error = std::max(error, std::abs(value)); };
      for (const char* name : {"k1", "k2", "mean", "quality"}) grow(k_error, vertex.at(name) - 0.5);
      grow(gauss_error, vertex.at("gauss") - 0.25);
      grow(radius_error, vertex.at("sh_radius") / (2.0 * kLargestNormalDeviation) - 1.0);
      const Vec3 n = vector_of(vertex, "n"), d1 = vector_of(vertex, "d1"), d2 = vector_of(vertex, "d2");
      grow(frame_error, d1.cross(d2).dot(n) - 1.0);
      grow(frame_error, d1.dot(d2));
    }
    EXPECT_LT(k_error, 0.01) << estimator;
    EXPECT_LT(gauss_error, 0.01) << estimator;
    EXPECT_LT(radius_error, 0.02) << estimator;
    EXPECT_LT(frame_error, 1e-5) << estimator;
  }
}

TEST_F(CurvatureCommand, WritesTheAgreedProperties) {
  ASSERT_EQ(run_vrc({"curvature", sphere(), "-o", file("k.ply")}).exit_code, 0);
  const test::ExportedPly ply = test::read_exported_ply(file("k.ply"));
  EXPECT_THAT(ply.vertex_properties,
              testing::IsSupersetOf({"float x", "float nx", "uchar red", "uchar green", "uchar blue",
                                     "float quality", "float k1", "float k2", "float d1x", "float d1y",
                                     "float d1z", "float d2x", "float d2y", "float d2z", "float sh_radius"}));
  EXPECT_THAT(ply.face_properties, testing::IsSupersetOf({"int patch", "int material"}));
}

TEST_F(CurvatureCommand, SummaryGivesRangeAndGaussBonnet) {
  const auto result =
      run_vrc({"curvature", sphere(), "-o", file("k.ply"), "--quantity", "gauss", "--threads", "1"});
  EXPECT_THAT(result.out, ContainsRegex("gauss \\[1/unit\\^2\\] +min 0\\.2.*, median 0\\.2.*, max 0\\.2"));
  EXPECT_THAT(result.out, ContainsRegex("sectors +3458 at 3458 vertices"));
  EXPECT_THAT(result.out, ContainsRegex("crease edges +0\n"));
  const std::string marker = "sum of K dA ";
  const std::size_t at = result.out.find(marker);
  ASSERT_NE(at, std::string::npos) << result.out;
  EXPECT_NEAR(std::stod(result.out.substr(at + marker.size())), 4.0 * kPi, 0.02 * 4.0 * kPi);
  EXPECT_THAT(result.out, HasSubstr("2 pi chi 12.566"));
}

TEST_F(CurvatureCommand, DoesNotReachAcrossCreases) {
  const std::string cube = mesh("cube.obj", test::kCubeObj);
  const auto result = run_vrc({"curvature", cube, "-o", file("k.ply")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const test::ExportedPly ply = test::read_exported_ply(file("k.ply"));
  EXPECT_EQ(ply.vertices.size(), 24u);
  for (const auto& vertex : ply.vertices) {
    EXPECT_NEAR(vertex.at("quality"), 0.0, 1e-12);
    EXPECT_NEAR(vertex.at("sh_radius"), std::sqrt(3.0), 1e-6);
  }
  EXPECT_THAT(result.out, ContainsRegex("crease edges +12\n"));
  // Rounding has no colours: the range is wide and every face has the middle one.
  EXPECT_THAT(result.out, ContainsRegex("colours +-0.57735 to 0.57735\n"));
  const auto open = run_vrc({"curvature", mesh("box.obj", test::kOpenBoxObj), "-o", file("b.ply")});
  EXPECT_THAT(open.out, HasSubstr("no closed component"));
}

TEST_F(CurvatureCommand, WritesVtpForParaView) {
  ASSERT_EQ(run_vrc({"curvature", sphere(), "-o", file("k.vtp")}).exit_code, 0);
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file(file("k.vtp").c_str()));
  const pugi::xml_node piece = document.child("VTKFile").child("PolyData").child("Piece");
  EXPECT_EQ(piece.attribute("NumberOfPoints").as_int(), 3458);
  EXPECT_EQ(piece.attribute("NumberOfPolys").as_int(), 6912);
  for (const char* name : {"d1", "d2"}) {
    const auto array = piece.child("PointData").find_child_by_attribute("DataArray", "Name", name);
    EXPECT_EQ(array.attribute("NumberOfComponents").as_int(), 3) << name;
    // An 8-byte length and three floats a point, four characters for three bytes.
    EXPECT_EQ(std::string(array.child_value()).size(), (8u + 3458u * 12u + 2u) / 3u * 4u);
  }
}

TEST_F(CurvatureCommand, DrawsAPicture) {
  const auto result = run_vrc({"curvature", sphere(), "-o", file("k.png"), "-o", file("k.ply"), "--quantity",
                               "max", "--size", "200x160"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(file("k.ply")));
  const Image image = read_image(file("k.png"));
  ASSERT_EQ(image.width, 200);
  ASSERT_EQ(image.height, 160);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(image.pixel(0, 0)[c], 1.0f);  // beside the sphere
  EXPECT_LT(image.pixel(100, 66)[0], 0.9f);                           // on it
  const float* dark = image.pixel(8, 140);                            // the two ends of the bar
  const float* bright = image.pixel(191, 140);
  EXPECT_LT(dark[1], 0.1f);
  EXPECT_GT(bright[1], 0.6f);
}

TEST_F(CurvatureCommand, BlueIsNegativeAndOrangePositive) {
  // A saddle z = x^2 - y^2 has k1 > 0 > k2 everywhere.
  PolygonSoup soup;
  constexpr int kCells = 12;
  for (int y = 0; y <= kCells; ++y) {
    for (int x = 0; x <= kCells; ++x) {
      const double u = 0.1 * (x - kCells / 2), v = 0.1 * (y - kCells / 2);
      soup.positions.emplace_back(u, v, 0.2 * (u * u - v * v));
    }
  }
  for (std::uint32_t y = 0; y < kCells; ++y) {
    for (std::uint32_t x = 0; x < kCells; ++x) {
      const std::uint32_t a = y * (kCells + 1) + x, b = a + kCells + 1;
      soup.add_face(std::array<std::uint32_t, 4>{a, a + 1, b + 1, b});
    }
  }
  const std::string saddle = mesh("saddle.obj", test::obj_text(soup));
  for (const auto& [quantity, orange] : {std::pair("k1", true), std::pair("k2", false)}) {
    ASSERT_EQ(run_vrc({"curvature", saddle, "-o", file("s.ply"), "--quantity", quantity}).exit_code, 0);
    const test::ExportedPly ply = test::read_exported_ply(file("s.ply"));
    const auto& middle = ply.vertices[ply.vertices.size() / 2];
    // Along y the surface is convex on the side of its normal, +z.
    EXPECT_NEAR(middle.at("k1"), 0.4, 0.02);
    EXPECT_NEAR(middle.at("k2"), -0.4, 0.02);
    EXPECT_EQ(middle.at("red") > middle.at("blue"), orange) << quantity;
  }
}

TEST_F(CurvatureCommand, FilesDoNotDependOnThreads) {
  const std::string mesh_file = sphere();
  for (const std::string threads : {"1", "2"}) {
    const std::string name = file(threads);
    ASSERT_EQ(run_vrc({"curvature", mesh_file, "-o", name + ".ply", "-o", name + ".vtp", "-o", name + ".png",
                       "--threads", threads})
                  .exit_code,
              0);
  }
  for (const char* extension : {".ply", ".vtp", ".png"}) {
    EXPECT_EQ(test::read_file(file("1") + extension), test::read_file(file("2") + extension)) << extension;
  }
}

TEST_F(CurvatureCommand, RefusesBadInput) {
  const std::string cube = mesh("cube.obj", test::kCubeObj);
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& part) {
    const auto result = run_vrc(arguments);
    EXPECT_EQ(result.exit_code, 2) << part;
    EXPECT_THAT(result.err, HasSubstr(part));
  };
  refused({"curvature", cube}, "--output");
  refused({"curvature", cube, "-o", file("k.stl")}, "k.stl");
  refused({"curvature", cube, "-o", file("none/k.ply")}, "none");
  refused({"curvature", cube, "-o", file("k.ply"), "-o", file("./k.ply")}, "two outputs");
  refused({"curvature", cube, "-o", file("k.ply"), "--quantity", "torsion"}, "torsion");
  refused({"curvature", cube, "-o", file("k.png"), "--size", "0x20"}, "0x20");
  refused({"curvature", file("none.obj"), "-o", file("k.ply")}, "none.obj");
  refused({"curvature", mesh("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "-o", file("k.ply")},
          "flat.obj");
  const std::string own = mesh("own.ply", test::sphere_ply(1.0, 2));
  refused({"curvature", own, "-o", own}, "input");
  refused({"curvature", test::write_test_scene(folder_.path()).string(), "-o", file("k.ply")},
          ".obj or .ply");
  EXPECT_FALSE(std::filesystem::exists(file("k.ply")));
  EXPECT_FALSE(std::filesystem::exists(file("k.png")));
}

TEST_F(CurvatureCommand, ItsHelpShowsAnExample) {
  const auto result = run_vrc({"curvature", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* part : {"--quantity", "--curvature", "--crease-angle", "--size", "sh_radius",
                           "vrc curvature bunny.obj -o bunny.ply"}) {
    EXPECT_THAT(result.out, HasSubstr(part));
  }
}

}  // namespace
}  // namespace vrc
