// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes with curved meshes, and the meshes against the script that makes them.
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

fs::path mesh_file(const std::string& name) {
  return fs::path(VRC_SOURCE_DIR) / "scenes/meshes" / (name + ".ply");
}

void expect_to_load(const std::string& name, const std::string& material) {
  SceneReadOptions options;
  options.defines["material"] = material;
  const SceneDescription description =
      read_scene(fs::path(VRC_SOURCE_DIR) / "scenes" / (name + ".xml"), options);
  EXPECT_TRUE(description.warnings.empty()) << name << ": " << description.warnings.front();
  const Scene scene(description);
  EXPECT_TRUE(std::ranges::any_of(scene.triangles(), [](const SceneTriangle& t) { return t.smooth != 0; }))
      << name << " has no curved surface";
}

TEST(SceneFiles, LoadWithBothKindsOfMaterial) {
  for (const char* name : {"pots", "object_sphere", "object_small_sphere", "object_torus", "object_bowl"}) {
    expect_to_load(name, "phong");
    expect_to_load(name, "ggx");
  }
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
    for (const char* defect : {"degenerate_faces", "duplicate_faces", "non_manifold_edges",
                               "non_manifold_vertices", "flipped_faces", "isolated_vertices"}) {
      EXPECT_EQ(mesh.at(defect), 0) << name << ": " << defect;
    }
  }
}

TEST(SceneFiles, HoldWhatTheScriptWrites) {
  if (std::system("python3 --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "there is no python3";
  const test::TempDir folder;
  const std::string command =
      "python3 '" VRC_SOURCE_DIR "/tools/make_scene_meshes.py' '" + folder.path().string() + "' > /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::size_t written = 0;
  for (const auto& file : fs::directory_iterator(folder.path())) {
    ++written;
    EXPECT_TRUE(test::read_file(file.path()) == test::read_file(mesh_file(file.path().stem().string())))
        << file.path().filename() << " differs; run tools/make_scene_meshes.py";
  }
  EXPECT_EQ(written, std::size(kMeshes));
}

}  // namespace
}  // namespace vrc
