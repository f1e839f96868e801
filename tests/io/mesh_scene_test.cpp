// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "io/scene_reader.h"
#include "support.h"

namespace vrc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A triangle in the material `m` of the library text.
SceneDescription read_with_mtl(const std::string& mtl) {
  const test::TempDir dir;
  test::write_file(dir / "m.mtl", mtl);
  test::write_file(dir / "m.obj", std::string("mtllib m.mtl\n") + kTriangle + "usemtl m\nf 1 2 3\n");
  return read_scene(dir / "m.obj");
}

float red(const Lobe& lobe) {
  return std::visit([](const auto& model) { return model.reflectance[0]; }, lobe);
}

SceneDescription read_plain(const SceneReadOptions& options = {}) {
  const test::TempDir dir;
  test::write_file(dir / "t.obj", std::string(kTriangle) + "f 1 2 3\n");
  return read_scene(dir / "t.obj", options);
}

TEST(MeshScene, PhongMaterialFromKdKsNs) {
  const SceneDescription scene = read_with_mtl("newmtl m\nKd 0.4 0.3 0.2\nKs 0.3 0.3 0.3\nNs 50\n");
  EXPECT_THAT(scene.warnings, IsEmpty());
  const Material& material = scene.materials.at(scene.shapes.at(0).materials.at(0));
  EXPECT_EQ(material.name, "m");
  EXPECT_TRUE(material.two_sided);
  ASSERT_THAT(material.lobes, SizeIs(2));
  EXPECT_FLOAT_EQ(std::get<LambertLobe>(material.lobes[0]).reflectance[1], 0.3f);
  EXPECT_FLOAT_EQ(std::get<PhongLobe>(material.lobes[1]).reflectance[0], 0.3f);
  EXPECT_FLOAT_EQ(std::get<PhongLobe>(material.lobes[1]).exponent, 50.0f);
}

TEST(MeshScene, WithoutGlossTheMaterialIsLambert) {
  for (const char* mtl :
       {"newmtl m\nKd 0.4 0.4 0.4\nKs 0 0 0\nNs 50\n", "newmtl m\nKd 0.4 0.4 0.4\nKs 1 1 1\nNs 0\n"}) {
    const SceneDescription scene = read_with_mtl(mtl);
    ASSERT_THAT(scene.materials.at(0).lobes, SizeIs(1)) << mtl;
    EXPECT_FLOAT_EQ(std::get<LambertLobe>(scene.materials[0].lobes[0]).reflectance[0], 0.4f);
  }
}

TEST(MeshScene, TooBrightMaterialsAreScaledDown) {
  const SceneDescription scene = read_with_mtl("newmtl m\nKd 0.8 0.2 0.2\nKs 0.8 0.2 0.2\nNs 10\n");
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("add up to 1.6; scaled down")));
  EXPECT_FLOAT_EQ(red(scene.materials.at(0).lobes.at(0)), 0.5f);
  EXPECT_FLOAT_EQ(red(scene.materials.at(0).lobes.at(1)), 0.5f);
}

TEST(MeshScene, RoughnessAndMetallicMakeGgx) {
  struct Case {
    const char* mtl;
    float alpha, glossy, diffuse;
  };
  const Case cases[] = {
      {"newmtl m\nKd 0.5 0.5 0.5\nKs 0.2 0.2 0.2\nPr 0.4\n", 0.16f, 0.2f, 0.5f},
      {"newmtl m\nKd 0.5 0.5 0.5\nPr 0.4\nPm 1\n", 0.16f, 0.5f, 0.0f},
      {"newmtl m\nKd 0.6 0.6 0.6\nPr 0\nPm 0.5\n", 0.001f, 0.3f, 0.3f},
  };
  for (const Case& c : cases) {
    const SceneDescription scene = read_with_mtl(c.mtl);
    const std::vector<Lobe>& lobes = scene.materials.at(0).lobes;
    ASSERT_THAT(lobes, SizeIs(c.diffuse > 0.0f ? 2 : 1)) << c.mtl;
    const GgxLobe& glossy = std::get<GgxLobe>(lobes.back());
    EXPECT_FLOAT_EQ(glossy.alpha, c.alpha) << c.mtl;
    EXPECT_FLOAT_EQ(glossy.reflectance[0], c.glossy) << c.mtl;
    EXPECT_FALSE(glossy.has_fresnel);
    if (c.diffuse > 0.0f) {
      EXPECT_FLOAT_EQ(red(lobes.front()), c.diffuse) << c.mtl;
    }
  }
}

TEST(MeshScene, KeMakesAnAreaLightAndNoStandIn) {
  const SceneDescription scene = read_with_mtl("newmtl m\nKd 0 0 0\nKe 5 4 3\n");
  ASSERT_THAT(scene.shapes, SizeIs(1));
  EXPECT_FLOAT_EQ(scene.shapes[0].emission.at(0)[1], 4.0f);
  EXPECT_THAT(scene.materials.at(0).lobes, IsEmpty());
  EXPECT_THAT(scene.notes, ElementsAre(HasSubstr("camera:")));
  EXPECT_EQ(scene.environment.maxCoeff(), 0.0f);
}

TEST(MeshScene, WhatIsMissingBecomesGreyWithAWarning) {
  EXPECT_THAT(read_with_mtl("newmtl other\nKd 1 0 0\n").warnings,
              ElementsAre(HasSubstr("material 'm' is not defined; grey is used")));
  const SceneDescription textured = read_with_mtl("newmtl m\nKd 1 1 1\nmap_Kd wood.png\n");
  EXPECT_THAT(textured.warnings,
              ElementsAre(::testing::AllOf(HasSubstr("textures are not supported"), HasSubstr("wood.png"))));
  EXPECT_FLOAT_EQ(red(textured.materials.at(0).lobes.at(0)), 0.5f);

  const test::TempDir dir;
  test::write_file(dir / "t.obj", std::string("mtllib none.mtl\n") + kTriangle + "usemtl m\nf 1 2 3\n");
  const SceneDescription scene = read_scene(dir / "t.obj");
  EXPECT_THAT(scene.warnings,
              ElementsAre(HasSubstr("there is no material library"), HasSubstr("'m' is not defined")));
  EXPECT_THAT(scene.materials.at(0).lobes, SizeIs(2));
}

TEST(MeshScene, EachFaceKeepsItsMaterial) {
  const test::TempDir dir;
  test::write_file(dir / "m.mtl", "newmtl a\nKd 0.1 0.1 0.1\nnewmtl b\nKd 0.2 0.2 0.2\nKe 1 1 1\n");
  test::write_file(dir / "m.obj", std::string("mtllib m.mtl\n") + kTriangle +
                                      "usemtl b\nf 1 2 3\nusemtl a\nf 3 2 1\nusemtl b\nf 2 3 1\n");
  const SceneDescription scene = read_scene(dir / "m.obj");
  const ShapeDescription& shape = scene.shapes.at(0);
  ASSERT_THAT(shape.materials, SizeIs(2));
  ASSERT_THAT(shape.soup.face_material, SizeIs(3));
  std::vector<std::string> names;
  for (const std::uint32_t m : shape.soup.face_material)
    names.push_back(scene.materials.at(shape.materials.at(m)).name);
  EXPECT_THAT(names, ElementsAre("b", "a", "b"));
  EXPECT_FLOAT_EQ(shape.emission.at(shape.soup.face_material[0])[0], 1.0f);
  EXPECT_FLOAT_EQ(shape.emission.at(shape.soup.face_material[1])[0], 0.0f);
}

TEST(MeshScene, PlyGetsAStandInMaterial) {
  const test::TempDir dir;
  const auto path =
      test::write_file(dir / "t.PLY",
                       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                       "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                       "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const SceneDescription scene = read_scene(path);
  ASSERT_THAT(scene.materials.at(0).lobes, SizeIs(2));
  EXPECT_TRUE(scene.materials[0].two_sided);
  EXPECT_FLOAT_EQ(red(scene.materials[0].lobes[0]), 0.5f);
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_EQ(scene.max_depth, 3);
}

TEST(MeshScene, CameraFramesTheMeshAndTheLightIsOutOfView) {
  for (const auto& [width, height] : {std::pair(512, 512), std::pair(300, 100), std::pair(100, 300)}) {
    SceneReadOptions options;
    options.width = width;
    options.height = height;
    const SceneDescription scene = read_plain(options);
    const Camera& camera = scene.camera;
    ASSERT_THAT(scene.shapes, SizeIs(2));
    EXPECT_EQ(camera.width, width);
    EXPECT_EQ(camera.height, height);
    const auto film = [&](const Vec3& p) {
      const Vec3 d = p - camera.origin;
      const double depth = d.dot(camera.forward);
      return Vec3(d.dot(camera.right) / depth / camera.tan_half_width,
                  d.dot(camera.up) / depth / camera.tan_half_width * width / height, depth);
    };
    for (const Vec3& p : scene.shapes[0].soup.positions) {
      EXPECT_GT(film(p).z(), 0.0);
      EXPECT_LT(film(p).head<2>().cwiseAbs().maxCoeff(), 1.0) << width << " x " << height;
    }
    for (const Vec3& p : scene.shapes[1].soup.positions) {
      EXPECT_TRUE(film(p).z() < 0.0 || film(p).head<2>().cwiseAbs().maxCoeff() > 1.0);
      EXPECT_GT((p - camera.origin).dot(camera.up), 0.0) << "above the shoulder";
      EXPECT_LT((p - camera.origin).dot(camera.right), 0.0) << "left of the camera";
    }
    EXPECT_GT(scene.shapes[1].emission.at(0).minCoeff(), 0.0f);
    EXPECT_GT(scene.environment.minCoeff(), 0.0f);
    EXPECT_THAT(scene.notes,
                ElementsAre(HasSubstr("camera: the file has none"), HasSubstr("light: the file has none")));
  }
}

TEST(MeshScene, StandInLightFacesTheMesh) {
  const SceneDescription scene = read_plain();
  const PolygonSoup& light = scene.shapes.at(1).soup;
  const auto corners = light.face_positions(0);
  const Vec3 normal = (light.positions[corners[1]] - light.positions[corners[0]])
                          .cross(light.positions[corners[2]] - light.positions[corners[0]]);
  EXPECT_GT(normal.dot(Vec3(0.5, 0.5, 0) - light.positions[corners[0]]), 0.0);
}

TEST(MeshScene, OptionsPlaceTheCamera) {
  SceneReadOptions options;
  options.camera_origin = Vec3(0, 0, 4);
  options.camera_target = Vec3(0, 0, 1);
  options.fov_degrees = 90.0;
  options.width = 20;
  const Camera camera = read_plain(options).camera;
  EXPECT_EQ(camera.origin, Vec3(0, 0, 4));
  EXPECT_LT((camera.direction(0, 256) - Vec3(-1, 0, -1)).norm(), 1e-9);
  EXPECT_EQ(camera.width, 20);
  EXPECT_EQ(camera.height, 512);

  options.camera_origin = Vec3(0, 9, 1);
  EXPECT_LT((read_plain(options).camera.forward - Vec3(0, -1, 0)).norm(), 1e-12)
      << "straight down is allowed";
}

TEST(MeshScene, BadInputIsRefused) {
  const test::TempDir dir;
  struct Case {
    const char* name;
    const char* content;
    const char* message;
  };
  const Case cases[] = {
      {"points.obj", "v 0 0 0\nv 1 0 0\n", "no faces"},
      {"dot.obj", "v 1 1 1\nf 1 1 1\n", "no extent"},
      {"scene.gltf", "{}", "give an .xml, .obj or .ply"},
      {"bad.obj", "v 0 0 0\nf 1 2 3\n", "bad.obj:2"},
  };
  for (const Case& c : cases) {
    try {
      static_cast<void>(read_scene(test::write_file(dir / c.name, c.content)));
      ADD_FAILURE() << c.name << " was accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.message)) << c.name;
      EXPECT_THAT(error.what(), HasSubstr(c.name));
    }
  }
  EXPECT_THROW(static_cast<void>(read_scene(dir / "missing.obj")), InputError);
  SceneReadOptions options;
  options.width = 0;
  EXPECT_THROW(static_cast<void>(read_plain(options)), InputError);
  options = {};
  options.fov_degrees = 180.0;
  EXPECT_THROW(static_cast<void>(read_plain(options)), InputError);
}

TEST(MeshScene, DefinesAreReported) {
  SceneReadOptions options;
  options.defines["spp"] = "3";
  EXPECT_THAT(read_plain(options).warnings, ElementsAre(HasSubstr("-D spp=3")));
}

}  // namespace
}  // namespace vrc
