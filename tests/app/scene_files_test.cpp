// SPDX-License-Identifier: GPL-3.0-or-later
// The scene files and their meshes, and these against the scripts that make them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/scene_reader.h"
#include "run_program.h"
#include "support.h"
#include "transport/scene.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestMeshFile = 200'000;
constexpr const char* kMeshes[] = {"pot_body",        "pot_lid", "pot_handle", "saucepan_body",
                                   "saucepan_handle", "bowl",    "torus",      "tile_row"};

constexpr const char* kDefects[] = {"degenerate_faces",      "duplicate_faces", "non_manifold_edges",
                                    "non_manifold_vertices", "flipped_faces",   "isolated_vertices"};

const fs::path kScenes = fs::path(VRC_SOURCE_DIR) / "scenes";

fs::path mesh_file(const std::string& name) { return kScenes / "meshes" / (name + ".ply"); }

void expect_to_load(const std::string& name, const std::string& material) {
  SceneReadOptions options;
  options.defines["material"] = material;
  const SceneDescription description = read_scene(kScenes / (name + ".xml"), options);
  EXPECT_TRUE(description.warnings.empty()) << name << ": " << description.warnings.front();
  const Scene scene(description);
  EXPECT_TRUE(std::ranges::any_of(scene.triangles(), [](const SceneTriangle& t) { return t.smooth != 0; }))
      << name << " has no curved surface";
}

TEST(SceneFiles, LoadWithBothKindsOfMaterial) {
  for (const char* name :
       {"pots", "object_sphere", "object_small_sphere", "object_torus", "object_bowl", "kitchen"}) {
    expect_to_load(name, "phong");
    expect_to_load(name, "ggx");
  }
}

TEST(SceneFiles, LoadAsTheyAre) {
  for (const auto& file : fs::directory_iterator(kScenes)) {
    if (file.path().extension() != ".xml") continue;
    const SceneDescription description = read_scene(file.path());
    EXPECT_TRUE(description.warnings.empty()) << file.path() << ": " << description.warnings.front();
    EXPECT_FALSE(description.shapes.empty()) << file.path();
  }
}

/// Six times the volume that the faces enclose.
double enclosed(const PolygonSoup& soup) {
  double total = 0.0;
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    const auto corners = soup.face_positions(face);
    for (std::size_t k = 2; k < corners.size(); ++k) {
      total +=
          soup.positions[corners[0]].dot(soup.positions[corners[k - 1]].cross(soup.positions[corners[k]]));
    }
  }
  return total;
}

/// Faces with a corner whose normal points to their inner side.
std::size_t faces_against_normals(const PolygonSoup& soup) {
  std::size_t count = 0;
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    const auto corners = soup.face_positions(face);
    const Vec3& origin = soup.positions[corners[0]];
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 2; k < corners.size(); ++k) {
      area += (soup.positions[corners[k - 1]] - origin).cross(soup.positions[corners[k]] - origin);
    }
    const auto normals = std::span(soup.corner_normal).subspan(soup.face_begin[face], corners.size());
    count += std::ranges::any_of(normals, [&](std::uint32_t n) { return soup.normals[n].dot(area) <= 0.0; });
  }
  return count;
}

TEST(SceneFiles, HaveNormalsThatPointOutOfTheMadeMeshes) {
  for (const char* name : {"kitchen.xml", "crown.xml"}) {
    for (const ShapeDescription& shape : read_scene(kScenes / name).shapes) {
      if (shape.soup.face_count() <= 1) continue;  // a wall or a lamp
      EXPECT_GT(enclosed(shape.soup), 0.0) << shape.id;
      if (!shape.soup.corner_normal.empty()) EXPECT_EQ(faces_against_normals(shape.soup), 0) << shape.id;
    }
  }
}

/// Triangles of the scene; all shapes but single rectangles are closed, and none has a defect.
std::size_t triangles_without_defects(const std::string& scene) {
  const auto result = test::run_vrc({"inspect", (kScenes / scene).string(), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  std::size_t triangles = 0;
  for (const auto& shape : report.at("shapes")) {
    const std::size_t count = shape.at("triangles");
    triangles += count;
    EXPECT_EQ(shape.at("watertight"), count > 2) << shape.at("id");
    for (const char* defect : kDefects) EXPECT_EQ(shape.at(defect), 0) << shape.at("id") << ": " << defect;
  }
  return triangles;
}

TEST(SceneFiles, HaveAKitchenOfClosedMeshes) {
  const std::size_t triangles = triangles_without_defects("kitchen.xml");
  EXPECT_GT(triangles, 200'000);
  EXPECT_LT(triangles, 400'000);
}

TEST(SceneFiles, HaveACrownOfClosedMeshes) {
  const std::size_t triangles = triangles_without_defects("crown.xml");
  EXPECT_GT(triangles, 400'000);
  EXPECT_LT(triangles, 600'000);
}

TEST(SceneFiles, NameTheMeshThatTheBuildHasNotMade) {
  const test::TempDir folder;
  fs::copy(kScenes / "crown.xml", folder / "crown.xml");
  const auto result = test::run_vrc({"inspect", (folder / "crown.xml").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("meshes/generated/crown_gold.ply"), std::string::npos) << result.err;
}

TEST(SceneFiles, HaveClosedMeshesWithoutDefects) {
  for (const std::string name : kMeshes) {
    EXPECT_LT(fs::file_size(mesh_file(name)), kLargestMeshFile) << name;
    const auto result =
        test::run_vrc({"inspect", mesh_file(name).string(), "--json", "--self-intersections"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto mesh = nlohmann::json::parse(result.out).at("shapes").at(0);
    EXPECT_EQ(mesh.at("watertight"), true) << name;
    EXPECT_EQ(mesh.at("genus"), name == "torus" ? 1 : 0);
    EXPECT_EQ(mesh.at("components"), name == "tile_row" ? 10 : 1);
    EXPECT_EQ(mesh.at("self_intersections").at("triangle_pairs"), 0) << name;
    for (const char* defect : kDefects) EXPECT_EQ(mesh.at(defect), 0) << name << ": " << defect;
  }
}

/// How many meshes the script writes, each the same bytes as the file in `meshes`.
std::size_t meshes_as_written(const std::string& script, const fs::path& meshes) {
  const test::TempDir folder;
  const std::string command =
      "python3 -B '" VRC_SOURCE_DIR "/tools/" + script + "' '" + folder.path().string() + "' > /dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::size_t written = 0;
  for (const auto& file : fs::directory_iterator(folder.path())) {
    ++written;
    EXPECT_TRUE(test::read_file(file.path()) == test::read_file(meshes / file.path().filename()))
        << file.path().filename() << " differs; run tools/" << script;
  }
  return written;
}

TEST(SceneFiles, HoldWhatTheScriptsWrite) {
  EXPECT_EQ(meshes_as_written("make_scene_meshes.py", kScenes / "meshes"), std::size(kMeshes));
  EXPECT_EQ(meshes_as_written("make_kitchen.py", kScenes / "meshes/generated"), 20);
  EXPECT_EQ(meshes_as_written("make_crown.py", kScenes / "meshes/generated"), 8);
}

}  // namespace
}  // namespace vrc
