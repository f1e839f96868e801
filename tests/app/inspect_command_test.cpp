// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_files.h"
#include "run_program.h"
#include "support.h"

namespace vrc {
namespace {

using test::run_vrc;
using testing::ContainsRegex;
using testing::HasSubstr;
using Json = nlohmann::json;

class InspectCommand : public testing::Test {
 protected:
  std::string mesh(const std::string& name, const std::string& text) {
    return test::write_file(folder_ / name, text).string();
  }
  static Json inspect(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "inspect");
    arguments.emplace_back("--json");
    const auto result = run_vrc(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  }
  static Json inspect_shape(const std::vector<std::string>& arguments) {
    const Json json = inspect(arguments);
    EXPECT_EQ(json.at("shapes").size(), 1u);
    return json.at("shapes").at(0);
  }

  test::TempDir folder_;
};

TEST_F(InspectCommand, CountsACube) {
  const Json cube = inspect_shape({mesh("cube.obj", test::kCubeObj), "--self-intersections"});
  EXPECT_EQ(cube.at("id"), "cube");
  EXPECT_EQ(cube.at("polygons"), 6);
  EXPECT_EQ(cube.at("triangles"), 12);
  EXPECT_EQ(cube.at("vertices"), 8);
  EXPECT_EQ(cube.at("edges"), 18);
  EXPECT_EQ(cube.at("components"), 1);
  EXPECT_EQ(cube.at("genus"), 0);
  EXPECT_EQ(cube.at("watertight"), true);
  EXPECT_EQ(cube.at("boundary_loops"), 0);
  EXPECT_EQ(cube.at("area"), 6.0);
  EXPECT_EQ(cube.at("bounds").at("max"), Json::array({1.0, 1.0, 1.0}));
  EXPECT_EQ(cube.at("regions"), 6);
  EXPECT_EQ(cube.at("creases").at("edges"), 12);
  EXPECT_EQ(cube.at("creases").at("angle"), 12);
  EXPECT_EQ(cube.at("self_intersections").at("triangle_pairs"), 0);
  for (const char* defect : {"degenerate_faces", "duplicate_faces", "non_manifold_edges",
                             "non_manifold_vertices", "flipped_faces", "isolated_vertices"}) {
    EXPECT_EQ(cube.at(defect), 0) << defect;
  }
}

TEST_F(InspectCommand, TheCreaseAngleDecides) {
  const std::string cube = mesh("cube.obj", test::kCubeObj);
  EXPECT_EQ(inspect_shape({cube, "--crease-angle", "100"}).at("creases").at("edges"), 0);
  EXPECT_EQ(inspect({cube, "--crease-angle", "100"}).at("crease_angle"), 100.0);
  EXPECT_EQ(inspect_shape({cube}).count("self_intersections"), 0u);
}

TEST_F(InspectCommand, SeesHolesAndReversedFaces) {
  // The last face is turned round, and a vertex is unused.
  std::string text = test::kOpenBoxObj + "v 9 9 9\n";
  text.replace(text.rfind("f 4 1 5 8"), 9, "f 8 5 1 4");
  const Json box = inspect_shape({mesh("box.obj", text)});
  EXPECT_EQ(box.at("watertight"), false);
  EXPECT_EQ(box.at("boundary_loops"), 1);
  EXPECT_EQ(box.at("boundary_edges"), 4);
  EXPECT_EQ(box.at("creases").at("boundary"), 4);
  EXPECT_EQ(box.at("flipped_faces"), 2);
  EXPECT_EQ(box.at("isolated_vertices"), 1);
  EXPECT_EQ(box.at("area"), 5.0);
}

TEST_F(InspectCommand, CountsDegenerateAndRepeatedFaces) {
  const Json cube = inspect_shape({mesh("c.obj", test::kCubeObj + "f 1 2 2\nf 4 3 2 1\n")});
  EXPECT_EQ(cube.at("polygons"), 8);
  EXPECT_EQ(cube.at("degenerate_faces"), 1);
  EXPECT_EQ(cube.at("duplicate_faces"), 1);
  EXPECT_EQ(cube.at("watertight"), true);
}

TEST_F(InspectCommand, FacesThatShareACornerDoNotIntersect) {
  const std::string bow_tie = "v 0 0 0\nv 1 1 0\nv 1 -1 0\nv -1 -1 0\nv -1 1 0\nf 1 3 2\nf 1 5 4\n";
  const Json json = inspect_shape({mesh("bow_tie.obj", bow_tie), "--self-intersections"});
  EXPECT_EQ(json.at("non_manifold_vertices"), 1);
  EXPECT_EQ(json.at("vertex_copies"), 1);
  EXPECT_EQ(json.at("components"), 2);
  EXPECT_EQ(json.at("self_intersections").at("triangle_pairs"), 0);
}

TEST_F(InspectCommand, FacesAroundANonManifoldEdgeDoNotIntersect) {
  const std::string fins = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
  const Json json = inspect_shape({mesh("fins.obj", fins), "--self-intersections"});
  EXPECT_EQ(json.at("non_manifold_edges"), 1);
  EXPECT_EQ(json.at("self_intersections").at("triangle_pairs"), 0);
}

TEST_F(InspectCommand, FindsFacesThatCrossOverlapOrFold) {
  const Json crossing = inspect_shape(
      {mesh("x.obj", "v -1 0 0\nv 1 0 0\nv 0 0 1\nv 0 -1 0.5\nv 0 1 0.5\nv 0 0 -1\nf 1 2 3\nf 4 5 6\n"),
       "--self-intersections"});
  EXPECT_EQ(crossing.at("self_intersections").at("triangle_pairs"), 1);
  EXPECT_EQ(crossing.at("self_intersections").at("first_polygons"), Json::parse("[[0, 1]]"));
  const Json folded =
      inspect_shape({mesh("fold.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.2 0.2 0\nf 1 2 3\nf 2 1 4\n"),
                     "--self-intersections"});
  EXPECT_EQ(folded.at("self_intersections").at("triangle_pairs"), 1);
  // Two faces with a common corner, one running through the other.
  const Json pierced =
      inspect_shape({mesh("p.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 1 1 -1\nv 1 0.5 1\nf 1 2 3\nf 1 4 5\n"),
                     "--self-intersections"});
  EXPECT_EQ(pierced.at("self_intersections").at("triangle_pairs"), 1);
}

TEST_F(InspectCommand, PrintsAnAlignedBlock) {
  const auto result = run_vrc({"inspect", mesh("cube.obj", test::kCubeObj), "--self-intersections"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("cube.obj: shape 1 of 1: cube\n"));
  EXPECT_THAT(result.out,
              ContainsRegex("\n  polygons                6 \\(6 with more than three corners\\)\n"));
  EXPECT_THAT(result.out, ContainsRegex("\n  watertight              yes\n"));
  EXPECT_THAT(result.out, ContainsRegex("\n  self-intersections      0 pairs of triangles\n"));
  for (const char c : result.out) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~'));
}

TEST_F(InspectCommand, ReportsEveryShapeOfAScene) {
  const Json json = inspect({test::write_test_scene(folder_.path()).string()});
  ASSERT_EQ(json.at("shapes").size(), 3u);
  EXPECT_EQ(json.at("shapes").at(0).at("triangles"), 2);
  EXPECT_EQ(json.at("shapes").at(2).at("triangles"), 12);
  EXPECT_EQ(json.at("shapes").at(2).at("watertight"), true);
}

TEST_F(InspectCommand, AMeshWithoutAreaHasNoBounds) {
  const std::string flat = mesh("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const Json json = inspect_shape({flat, "--self-intersections"});
  EXPECT_TRUE(json.at("bounds").is_null());
  EXPECT_EQ(json.at("triangles"), 0);
  EXPECT_EQ(json.at("watertight"), false);
  EXPECT_EQ(json.at("degenerate_faces"), 1);
  const auto text = run_vrc({"inspect", flat});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.out, ContainsRegex("\n  bounds +none\n"));
}

TEST_F(InspectCommand, RefusesBadFilesAndNumbers) {
  const std::string cube = mesh("cube.obj", test::kCubeObj);
  const std::string bad = mesh("bad.obj", "v 0 0 0\nf 1 2 3\n");
  const auto missing = run_vrc({"inspect", (folder_ / "none.ply").string()});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("none.ply"));
  const auto malformed = run_vrc({"inspect", bad});
  EXPECT_EQ(malformed.exit_code, 2);
  EXPECT_THAT(malformed.err, HasSubstr("bad.obj:2:"));
  EXPECT_EQ(run_vrc({"inspect", mesh("cube.stl", "solid")}).exit_code, 2);
  EXPECT_EQ(run_vrc({"inspect", cube, "--crease-angle", "190"}).exit_code, 2);
  EXPECT_EQ(run_vrc({"inspect", cube, "--crease-angle", "nan"}).exit_code, 2);
  EXPECT_EQ(run_vrc({"inspect"}).exit_code, 2);
  EXPECT_EQ(run_vrc({"inspect", folder_.path().string()}).exit_code, 2);
}

}  // namespace
}  // namespace vrc
