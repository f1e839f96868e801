// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/error.h"
#include "io/scene_reader.h"
#include "support.h"

namespace vrc {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kLight = "<emitter type='constant'/>";
constexpr const char* kSensor = "<sensor type='perspective'><float name='fov' value='90'/></sensor>";

/// A scene on line 1 whose `body` starts on line 2; with a light and a sensor after the body.
std::string scene_text(const std::string& body) {
  return "<scene version='3.0.0'>\n" + body + "\n" + kLight + kSensor + "</scene>\n";
}

std::string rectangle(const std::string& content) {
  return "<shape type='rectangle'>" + content + "</shape>";
}

SceneDescription read_text(const std::string& text, const SceneReadOptions& options = {}) {
  const test::TempDir dir;
  return read_scene(test::write_file(dir / "scene.xml", text), options);
}

SceneDescription read_body(const std::string& body, const SceneReadOptions& options = {}) {
  return read_text(scene_text(body), options);
}

Material read_material(const std::string& bsdf, const SceneReadOptions& options = {}) {
  const SceneDescription scene = read_body(rectangle(bsdf), options);
  return scene.materials.at(scene.shapes.at(0).materials.at(0));
}

std::string error_of(const std::string& text, const SceneReadOptions& options = {}) {
  try {
    static_cast<void>(read_text(text, options));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

SceneReadOptions lenient() {
  SceneReadOptions options;
  options.lenient = true;
  return options;
}

void expect_color(const Rgb& actual, const Rgb& expected) {
  EXPECT_LT((actual - expected).abs().maxCoeff(), 1e-5f)
      << actual.transpose() << " instead of " << expected.transpose();
}

void expect_near(const Vec3& actual, const Vec3& expected) {
  EXPECT_LT((actual - expected).norm(), 1e-9) << actual.transpose() << " instead of " << expected.transpose();
}

// Shapes and transforms.

/// Where a <transform> takes a point: that of a point light.
Vec3 transformed_origin(const std::string& operations) {
  const SceneDescription scene =
      read_body(rectangle("") + "<emitter type='point'><transform name='to_world'>" + operations +
                "</transform></emitter>");
  return std::get<PointLight>(scene.delta_lights.at(0)).position;
}

TEST(Mitsuba, TransformOperationsApplyInOrder) {
  const std::pair<const char*, Vec3> cases[] = {
      {"<translate x='1' y='2' z='3'/>", {1, 2, 3}},
      {"<translate value='1, 2 3'/>", {1, 2, 3}},
      {"<translate x='1'/><rotate z='1' angle='90'/>", {0, 1, 0}},
      {"<rotate z='1' angle='90'/><translate x='1'/>", {1, 0, 0}},
      {"<translate x='1'/><scale value='2'/><translate y='1'/>", {2, 1, 0}},
      {"<translate x='1' y='1' z='1'/><scale x='2' z='3'/>", {2, 1, 3}},
      {"<translate x='1' y='1' z='1'/><scale value='2 3 4'/>", {2, 3, 4}},
      {"<translate z='1'/><rotate x='1' angle='-90'/>", {0, 1, 0}},
      {"<translate x='1'/><rotate value='1 1 1' angle='120'/>", {0, 1, 0}},
      {"<translate x='1'/><matrix value='0 0 1 5  1 0 0 6  0 1 0 7  0 0 0 1'/>", {5, 7, 7}},
      {"<translate x='1' y='2'/><matrix value='0 -1 0  1 0 0  0 0 1'/>", {-2, 1, 0}},
      {"<translate z='2'/><lookat origin='1,0,0' target='1,0,-9' up='0,1,0'/>", {1, 0, -2}},
      {"<translate x='2'/><lookat origin='1,0,0' target='1,0,-9' up='0,1,0'/>", {-1, 0, 0}},
      {"<translate y='2'/><lookAt origin='0,0,0' target='0,0,-9'/>", {0, 2, 0}},
  };
  for (const auto& [operations, expected] : cases) {
    SCOPED_TRACE(operations);
    expect_near(transformed_origin(operations), expected);
  }
}

TEST(Mitsuba, ShapesAreInWorldSpace) {
  struct Case {
    const char* shape;
    Vec3 min, max;
  };
  const Case cases[] = {
      {"<shape type='rectangle'/>", {-1, -1, 0}, {1, 1, 0}},
      {"<shape type='cube'><transform name='to_world'><scale x='2'/></transform></shape>",
       {-2, -1, -1},
       {2, 1, 1}},
      {"<shape type='disk'/>", {-1, -1, 0}, {1, 1, 0}},
      {"<shape type='sphere'><point name='center' x='1'/><float name='radius' value='2'/></shape>",
       {-1, -2, -2},
       {3, 2, 2}},
      {"<shape type='cylinder'><point name='p0' value='0 0 1'/><point name='p1' value='0 0 4'/>"
       "<float name='radius' value='0.5'/></shape>",
       {-0.5, -0.5, 1},
       {0.5, 0.5, 4}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.shape);
    const Box3 box = read_body(c.shape).shapes.at(0).soup.bounds();
    EXPECT_LT((box.min() - c.min).norm(), 1e-2);
    EXPECT_LT((box.max() - c.max).norm(), 1e-2);
  }
}

Vec3 first_face_normal(const PolygonSoup& soup) {
  const auto corners = soup.face_positions(0);
  return (soup.positions[corners[1]] - soup.positions[corners[0]])
      .cross(soup.positions[corners[2]] - soup.positions[corners[0]])
      .normalized();
}

TEST(Mitsuba, FlippedAndMirroredShapes) {
  const std::string mirror = "<transform name='to_world'><scale x='-1'/></transform>";
  const std::string flip = "<boolean name='flip_normals' value='true'/>";
  const std::string old_flip = "<boolean name='flipNormals' value='true'/>";
  expect_near(first_face_normal(read_body(rectangle("")).shapes.at(0).soup), Vec3(0, 0, 1));
  expect_near(first_face_normal(read_body(rectangle(mirror)).shapes.at(0).soup), Vec3(0, 0, 1));
  for (const std::string& content : {flip, old_flip, mirror + flip}) {
    const PolygonSoup soup = read_body(rectangle(content)).shapes.at(0).soup;
    expect_near(first_face_normal(soup), Vec3(0, 0, -1));
    for (const Vec3& normal : soup.normals) expect_near(normal, Vec3(0, 0, -1));
  }
  EXPECT_FALSE(read_body(rectangle("")).shapes.at(0).face_normals);
  EXPECT_TRUE(read_body(rectangle("<boolean name='faceNormals' value='true'/>")).shapes.at(0).face_normals);
}

TEST(Mitsuba, MeshFilesAndTheirMaterials) {
  const test::TempDir dir;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl lamp\nf 3 2 1\n";
  test::write_file(dir / "sub/with.obj", "mtllib with.mtl\n" + triangle);
  test::write_file(dir / "sub/with.mtl", "newmtl red\nKd 0.7 0 0\nnewmtl lamp\nKd 0 0 0\nKe 2 2 2\n");
  test::write_file(dir / "sub/without.obj", "mtllib none.mtl\n" + triangle);
  const auto read = [&](const std::string& content) {
    return read_scene(
        test::write_file(dir / "scene.xml", scene_text("<shape type='obj'>" + content + "</shape>")));
  };
  const auto file = [](const std::string& name) { return "<string name='filename' value='" + name + "'/>"; };

  const SceneDescription own = read(file("sub/with.obj"));
  ASSERT_THAT(own.shapes.at(0).materials, SizeIs(2));
  expect_color(std::get<LambertLobe>(own.materials.at(own.shapes[0].materials[0]).lobes.at(0)).reflectance,
               Rgb(0.7f, 0, 0));
  EXPECT_FLOAT_EQ(own.shapes[0].emission.at(1)[0], 2.0f);

  const SceneDescription overruled = read(file("sub/with.obj") + "<bsdf type='diffuse' id='b'/>");
  ASSERT_THAT(overruled.shapes.at(0).materials, SizeIs(1));
  EXPECT_THAT(overruled.shapes[0].soup.face_material, IsEmpty());
  EXPECT_EQ(overruled.materials.at(overruled.shapes[0].materials[0]).name, "b");

  const SceneDescription plain = read(file("sub/without.obj"));
  EXPECT_THAT(plain.warnings, IsEmpty()) << "Mitsuba never looks for the library";
  expect_color(std::get<LambertLobe>(plain.materials.at(0).lobes.at(0)).reflectance, Rgb::Constant(0.5f));

  const SceneDescription light =
      read(file("sub/with.obj") + "<emitter type='area'><float name='radiance' value='3'/></emitter>");
  EXPECT_THAT(light.shapes.at(0).emission, SizeIs(2));
  for (const Rgb& emission : light.shapes[0].emission) expect_color(emission, Rgb::Constant(3.0f));
}

TEST(Mitsuba, PathElementsAreSearched) {
  const test::TempDir dir;
  test::write_file(dir / "meshes/t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string shape = "<shape type='obj'><string name='filename' value='t.obj'/></shape>";
  const auto path = test::write_file(dir / "scene.xml", scene_text("<path value='meshes'/>" + shape));
  EXPECT_EQ(read_scene(path).shapes.at(0).soup.face_count(), 1u);
  test::write_file(path, scene_text(shape));
  EXPECT_THROW(static_cast<void>(read_scene(path)), InputError);
}

// Materials.

TEST(Mitsuba, Colors) {
  const std::pair<const char*, Rgb> cases[] = {
      {"<rgb name='reflectance' value='0.1 0.2 0.3'/>", {0.1f, 0.2f, 0.3f}},
      {"<rgb name='reflectance' value='0.1, 0.2,0.3'/>", {0.1f, 0.2f, 0.3f}},
      {"<rgb name='reflectance' value='+0.4'/>", {0.4f, 0.4f, 0.4f}},
      {"<rgb name='reflectance' value='#ff8000'/>", {1.0f, 0.2158605f, 0.0f}},
      {"<srgb name='reflectance' value='1 0.5 0'/>", {1.0f, 0.2140411f, 0.0f}},
      {"<spectrum name='reflectance' value='0.25'/>", {0.25f, 0.25f, 0.25f}},
      {"<float name='reflectance' value='2.5e-1'/>", {0.25f, 0.25f, 0.25f}},
      {"<rgb name='diffuseReflectance' value='0.3'/>", {0.3f, 0.3f, 0.3f}},
      {"", {0.5f, 0.5f, 0.5f}},
  };
  for (const auto& [property, expected] : cases) {
    SCOPED_TRACE(property);
    const Material material = read_material(std::string("<bsdf type='diffuse'>") + property + "</bsdf>");
    ASSERT_THAT(material.lobes, SizeIs(1));
    expect_color(std::get<LambertLobe>(material.lobes[0]).reflectance, expected);
    EXPECT_FALSE(material.two_sided);
  }
}

TEST(Mitsuba, Phong) {
  Material material = read_material("<bsdf type='phong'/>");
  ASSERT_THAT(material.lobes, SizeIs(2));
  expect_color(std::get<LambertLobe>(material.lobes[0]).reflectance, Rgb::Constant(0.5f));
  expect_color(std::get<PhongLobe>(material.lobes[1]).reflectance, Rgb::Constant(0.2f));
  EXPECT_EQ(std::get<PhongLobe>(material.lobes[1]).exponent, 30.0f);

  material = read_material(
      "<bsdf type='twosided'><bsdf type='phong'><float name='exponent' value='100'/>"
      "<rgb name='diffuseReflectance' value='0'/><rgb name='specularReflectance' "
      "value='0.8'/></bsdf></bsdf>");
  ASSERT_THAT(material.lobes, SizeIs(1));
  expect_color(std::get<PhongLobe>(material.lobes[0]).reflectance, Rgb::Constant(0.8f));
  EXPECT_EQ(std::get<PhongLobe>(material.lobes[0]).exponent, 100.0f);
  EXPECT_TRUE(material.two_sided);
}

TEST(Mitsuba, RoughConductor) {
  const auto read = [](const std::string& properties, const SceneReadOptions& options = {}) {
    const Material material = read_material("<bsdf type='roughconductor'>" + properties + "</bsdf>", options);
    return std::get<GgxLobe>(material.lobes.at(0));
  };
  const std::string ggx = "<string name='distribution' value='ggx'/>";

  GgxLobe lobe = read(ggx +
                      "<float name='alpha' value='0.14'/><string name='material' value='none'/>"
                      "<rgb name='specular_reflectance' value='0.9'/>");
  EXPECT_FLOAT_EQ(lobe.alpha, 0.14f);
  EXPECT_FALSE(lobe.has_fresnel);
  expect_color(lobe.reflectance, Rgb::Constant(0.9f));

  lobe = read(
      ggx +
      "<float name='alphaU' value='0.3'/><float name='alphaV' value='0.3'/>"
      "<rgb name='eta' value='0.2 0.9 1.1'/><float name='k' value='3'/><float name='ext_eta' value='2'/>");
  EXPECT_FLOAT_EQ(lobe.alpha, 0.3f);
  EXPECT_TRUE(lobe.has_fresnel);
  expect_color(lobe.eta, Rgb(0.1f, 0.45f, 0.55f));
  expect_color(lobe.k, Rgb::Constant(1.5f));

  // Reflectance at normal incidence, ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2), against what is known of
  // the metals: silver and aluminium are nearly white, gold and copper are warm.
  const std::pair<const char*, Rgb> metals[] = {
      {"Ag", {0.97f, 0.96f, 0.91f}}, {"Al", {0.92f, 0.92f, 0.92f}}, {"Au", {0.97f, 0.80f, 0.34f}},
      {"Cr", {0.68f, 0.64f, 0.69f}}, {"Cu", {0.95f, 0.62f, 0.51f}},
  };
  for (const auto& [name, expected] : metals) {
    lobe = read(ggx + "<string name='material' value='" + name + "'/>");
    const Rgb reflected =
        ((lobe.eta - 1).square() + lobe.k.square()) / ((lobe.eta + 1).square() + lobe.k.square());
    EXPECT_LT((reflected - expected).abs().maxCoeff(), 0.03f) << name << ": " << reflected.transpose();
  }
  EXPECT_TRUE((read(ggx).eta == lobe.eta).all()) << "copper is Mitsuba's default";
  EXPECT_FLOAT_EQ(read("", lenient()).alpha, 0.1f) << "beckmann becomes ggx";
}

TEST(Mitsuba, Blend) {
  const Material material = read_material(
      "<bsdf type='twosided'><bsdf type='blendbsdf'><float name='weight' value='0.25'/>"
      "<bsdf type='diffuse'><rgb name='reflectance' value='0.8'/></bsdf>"
      "<bsdf type='roughconductor'><string name='distribution' value='ggx'/><string name='material' "
      "value='none'/>"
      "</bsdf></bsdf></bsdf>");
  ASSERT_THAT(material.lobes, SizeIs(2));
  expect_color(std::get<LambertLobe>(material.lobes[0]).reflectance, Rgb::Constant(0.6f));
  expect_color(std::get<GgxLobe>(material.lobes[1]).reflectance, Rgb::Constant(0.25f));
  EXPECT_TRUE(material.two_sided);
}

TEST(Mitsuba, TooBrightMaterialsWarn) {
  const SceneDescription scene =
      read_body(rectangle("<bsdf type='phong'><rgb name='diffuse_reflectance' value='0.2 0.9 0.2'/></bsdf>"));
  EXPECT_THAT(scene.warnings,
              ElementsAre(AllOf(HasSubstr("scene.xml:2: <bsdf type=\"phong\">"), HasSubstr("1.1"))));
}

TEST(Mitsuba, ReferencesShareOneMaterial) {
  const SceneDescription scene = read_body(
      "<shape type='rectangle' id='late'><ref id='m'/></shape>"
      "<bsdf type='diffuse' id='m'><rgb name='reflectance' value='0.7'/></bsdf>"
      "<shape type='cube' id='early'><ref name='bsdf' id='m'/></shape><shape type='disk'/><shape "
      "type='disk'/>");
  ASSERT_THAT(scene.shapes, SizeIs(4));
  EXPECT_EQ(scene.shapes[0].id, "late");
  EXPECT_EQ(scene.shapes[0].materials, scene.shapes[1].materials);
  EXPECT_EQ(scene.shapes[2].materials, scene.shapes[3].materials);
  EXPECT_NE(scene.shapes[0].materials, scene.shapes[2].materials);
  EXPECT_THAT(scene.materials, SizeIs(2));
  EXPECT_EQ(scene.materials.at(scene.shapes[0].materials.at(0)).name, "m");
}

// Emitters.

TEST(Mitsuba, Emitters) {
  const SceneDescription scene = read_text(
      "<scene version='2.1.0'>" +
      rectangle("<emitter type='area'><rgb name='radiance' value='1 2 3'/></emitter>") +
      "<emitter type='point'><point name='position' x='1' z='3'/><rgb name='intensity' value='4'/></emitter>"
      "<emitter type='directional'><vector name='direction' value='0 -2 0'/><float name='irradiance' "
      "value='5'/></emitter>"
      "<emitter type='directional'><transform name='toWorld'><rotate y='1' angle='90'/></transform></emitter>"
      "<emitter type='constant'><rgb name='radiance' value='0.1 0.2 0.3'/></emitter></scene>");
  expect_color(scene.shapes.at(0).emission.at(0), Rgb(1, 2, 3));
  ASSERT_THAT(scene.delta_lights, SizeIs(3));
  expect_near(std::get<PointLight>(scene.delta_lights[0]).position, Vec3(1, 0, 3));
  expect_color(std::get<PointLight>(scene.delta_lights[0]).intensity, Rgb::Constant(4));
  expect_near(std::get<DirectionalLight>(scene.delta_lights[1]).direction, Vec3(0, -1, 0));
  expect_color(std::get<DirectionalLight>(scene.delta_lights[1]).irradiance, Rgb::Constant(5));
  expect_near(std::get<DirectionalLight>(scene.delta_lights[2]).direction, Vec3(1, 0, 0));
  expect_color(scene.environment, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_THAT(scene.notes, ElementsAre(HasSubstr("camera: the file has none")));
}

TEST(Mitsuba, WithoutEmitterTheStandInLightIsNoted) {
  const SceneDescription scene = read_text("<scene version='3.0.0'><shape type='sphere'/></scene>");
  EXPECT_THAT(scene.shapes, SizeIs(2));
  EXPECT_THAT(scene.notes, ElementsAre(HasSubstr("camera:"), HasSubstr("light: the file has none")));
}

// Sensor, film, integrator.

SceneDescription read_sensor(const std::string& content, const SceneReadOptions& options = {}) {
  return read_text("<scene version='3.0.0'>" + rectangle("") + kLight + "<sensor type='perspective'>" +
                       content + "</sensor></scene>",
                   options);
}

const std::string kFov90 = "<float name='fov' value='90'/>";

std::string film(int width, int height, const std::string& content = "") {
  return "<film type='hdrfilm'><integer name='width' value='" + std::to_string(width) +
         "'/><integer name='height' value='" + std::to_string(height) + "'/>" + content + "</film>";
}

TEST(Mitsuba, LookatCameraPointsAsMitsubasDoes) {
  const Camera camera =
      read_sensor(kFov90 + film(200, 100) +
                  "<transform name='to_world'><lookat origin='1,2,3' target='1,2,-4' up='0,1,0'/>"
                  "</transform>")
          .camera;
  expect_near(camera.origin, Vec3(1, 2, 3));
  // Looking along -z with y up, x grows to the right. Pixel (150, 25) is half-way to the right edge and
  // half-way to the upper one, which is at half the tangent.
  expect_near(camera.direction(150, 25), Vec3(0.5, 0.25, -1));
  expect_near(camera.direction(0, 0), Vec3(-1, 0.5, -1));
}

TEST(Mitsuba, CameraWithoutTransformLooksAlongZWithXToTheLeft) {
  const Camera camera = read_sensor(kFov90 + film(100, 100)).camera;
  expect_near(camera.direction(0, 0), Vec3(1, 1, 1));
  expect_near(camera.direction(100, 100), Vec3(-1, -1, 1));
}

TEST(Mitsuba, ScaledAndMirroredCameras) {
  const std::string scale = "<transform name='toWorld'><scale x='2' y='2' z='2'/></transform>";
  expect_near(read_sensor(kFov90 + film(100, 100) + scale).camera.direction(0, 0), Vec3(1, 1, 1));
  const std::string mirror = "<transform name='toWorld'><scale x='-3'/></transform>";
  expect_near(read_sensor(kFov90 + film(100, 100) + mirror).camera.direction(0, 0), Vec3(-1, 1, 1));
}

TEST(Mitsuba, FieldOfViewAxes) {
  struct Case {
    const char* axis;
    int width, height;
    double expected;  ///< tan_half_width for fov 90
  };
  const Case cases[] = {
      {"x", 200, 100, 1.0},        {"y", 200, 100, 2.0},
      {"smaller", 200, 100, 2.0},  {"larger", 200, 100, 1.0},
      {"smaller", 100, 200, 1.0},  {"larger", 100, 200, 0.5},
      {"diagonal", 300, 400, 0.6}, {"diagonal", 100, 100, std::sqrt(0.5)},
  };
  for (const Case& c : cases) {
    const std::string axis = std::string("<string name='fovAxis' value='") + c.axis + "'/>";
    EXPECT_NEAR(read_sensor(kFov90 + axis + film(c.width, c.height)).camera.tan_half_width, c.expected, 1e-12)
        << c.axis << " " << c.width << " x " << c.height;
  }
  // A 35 mm frame: the half diagonal is 21.63 mm.
  const double diagonal = std::hypot(18.0, 12.0) / 50.0;
  EXPECT_NEAR(read_sensor(film(300, 400)).camera.tan_half_width, 0.6 * diagonal, 1e-12);
  EXPECT_NEAR(
      read_sensor(film(300, 400) + "<string name='focal_length' value='25mm'/>").camera.tan_half_width,
      1.2 * diagonal, 1e-12);
}

TEST(Mitsuba, FilmSamplerAndFilter) {
  SceneDescription scene =
      read_sensor(kFov90 + film(64, 32, "<rfilter type='box'/><string name='pixelFormat' value='rgb'/>") +
                  "<sampler type='independent'><integer name='sampleCount' value='7'/><integer name='seed' "
                  "value='3'/></sampler>"
                  "<float name='nearClip' value='0.1'/><float name='far_clip' value='9'/><float "
                  "name='focus_distance' value='1'/>");
  EXPECT_EQ(scene.camera.width, 64);
  EXPECT_EQ(scene.camera.height, 32);
  EXPECT_EQ(scene.samples_per_pixel, 7);
  EXPECT_EQ(scene.film.filter, PixelFilter::kBox);
  EXPECT_THAT(scene.warnings, IsEmpty());

  scene = read_sensor(kFov90 +
                      film(8, 8, "<rfilter type='gaussian'><float name='stddev' value='0.7'/></rfilter>"));
  EXPECT_EQ(scene.film.filter, PixelFilter::kGaussian);
  EXPECT_DOUBLE_EQ(scene.film.gaussian_stddev, 0.7);
  EXPECT_EQ(read_sensor(kFov90 + film(8, 8)).film.filter, PixelFilter::kGaussian) << "Mitsuba's default";
  EXPECT_EQ(read_sensor(kFov90).camera.width, 768);
  for (const char* type : {"ldrfilm", "mfilm"}) {
    const std::string text =
        "<film type='" + std::string(type) + "'><integer name='width' value='9'/></film>";
    EXPECT_EQ(read_sensor(kFov90 + text).camera.width, 9) << type;
  }
}

TEST(Mitsuba, OptionsSetTheFilmSizeBeforeTheFieldOfView) {
  SceneReadOptions options;
  options.width = 400;
  const Camera camera =
      read_sensor(kFov90 + "<string name='fov_axis' value='y'/>" + film(100, 100), options).camera;
  EXPECT_EQ(camera.width, 400);
  EXPECT_EQ(camera.height, 100);
  EXPECT_NEAR(camera.tan_half_width, 4.0, 1e-12);
}

TEST(Mitsuba, MaxDepthOfIntegrators) {
  const std::pair<const char*, int> cases[] = {
      {"", -1},
      {"<integrator type='path'/>", -1},
      {"<integrator type='volpathmis'><integer name='maxDepth' value='5'/><integer name='rr_depth' "
       "value='9'/></integrator>",
       5},
      {"<integrator type='direct'/>", 2},
      {"<integrator type='aov'><string name='aovs' value='d:depth'/><integrator type='path'>"
       "<integer name='max_depth' value='3'/></integrator></integrator>",
       3},
  };
  for (const auto& [integrator, expected] : cases) {
    const SceneDescription scene = read_body(integrator + rectangle(""));
    EXPECT_EQ(scene.max_depth, expected) << integrator;
    EXPECT_THAT(scene.warnings, IsEmpty());
  }
}

TEST(Mitsuba, TheFirstOfTwoSensorsIsUsed) {
  const SceneDescription scene = read_body(rectangle("") + "<sensor type='perspective' id='first'>" + kFov90 +
                                           film(11, 11) + "</sensor>");
  EXPECT_EQ(scene.camera.width, 11);
  EXPECT_THAT(scene.notes, ElementsAre(AllOf(HasSubstr("2 sensors"), HasSubstr("first"))));
}

// Parameters and includes.

TEST(Mitsuba, DefaultsAndDefines) {
  const std::string text = scene_text(
      "<default name='spp' value='5'/><default name='mesh_type' value='cube'/>"
      "<default name='r' value='0.25'/><default name='rg' value='$r, 0.5'/>"
      "<shape type='$mesh_type'><bsdf type='diffuse'>"
      "<rgb name='reflectance' value='$rg, $r'/></bsdf></shape>");
  SceneDescription scene = read_text(text);
  EXPECT_EQ(scene.shapes.at(0).soup.face_count(), 6u);
  expect_color(std::get<LambertLobe>(scene.materials.at(0).lobes.at(0)).reflectance, Rgb(0.25f, 0.5f, 0.25f));

  SceneReadOptions options;
  options.defines = {{"mesh_type", "rectangle"}, {"r", "0.75"}, {"no_such", "1"}};
  scene = read_text(text, options);
  EXPECT_EQ(scene.shapes.at(0).soup.face_count(), 1u);
  expect_color(std::get<LambertLobe>(scene.materials.at(0).lobes.at(0)).reflectance, Rgb(0.75f, 0.5f, 0.75f));
  EXPECT_THAT(scene.warnings, ElementsAre(AllOf(HasSubstr("-D no_such=1"), HasSubstr("$no_such"))));
}

TEST(Mitsuba, IncludesAreRelativeAndSeeTheParameters) {
  const test::TempDir dir;
  const auto path = test::write_file(dir / "main.xml", scene_text("<default name='kind' value='cube'/>\n"
                                                                  "<include filename='parts/all.xml'/>"));
  test::write_file(dir / "parts/all.xml",
                   "<scene version='3.0.0'><default name='kind' value='disk'/>"
                   "<include filename='shape.xml'/><include filename='shape.xml'/></scene>");
  test::write_file(dir / "parts/shape.xml", "<shape type='$kind'/>");
  const SceneDescription scene = read_scene(path);
  ASSERT_THAT(scene.shapes, SizeIs(2));
  EXPECT_EQ(scene.shapes[0].soup.face_count(), 6u) << "the including file's value goes first";

  test::write_file(dir / "parts/shape.xml", "\n\n<shape type='teapot'/>");
  try {
    static_cast<void>(read_scene(path));
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("parts/shape.xml:3: <shape type=\"teapot\">"));
  }
}

TEST(Mitsuba, IncludeCyclesAreRefused) {
  const test::TempDir dir;
  const auto path = test::write_file(dir / "a.xml", scene_text("<include filename='b.xml'/>"));
  test::write_file(dir / "b.xml", "<scene version='3.0.0'>\n<include filename='./sub/../a.xml'/></scene>");
  std::filesystem::create_directory(dir / "sub");
  try {
    static_cast<void>(read_scene(path));
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("b.xml:2: <include>"), HasSubstr("leads back to itself")));
  }

  // Two includes of the next file in each of 30 files would be 2^30 includes.
  for (int i = 0; i < 30; ++i) {
    const std::string next = "<include filename='c" + std::to_string(i + 1) + ".xml'/>";
    test::write_file(dir / ("c" + std::to_string(i) + ".xml"),
                     "<scene version='3.0.0'>" + next + next + "</scene>");
  }
  test::write_file(dir / "c30.xml", "<shape type='disk'/>");
  EXPECT_THROW(static_cast<void>(read_scene(dir / "c0.xml")), InputError);
}

// What is refused.

TEST(Mitsuba, ErrorsNameFileLineAndElement) {
  struct Case {
    const char* body;  ///< Starts on line 2.
    std::vector<std::string> fragments;
  };
  const std::string kSquare = "<shape type='rectangle'/>";
  const Case cases[] = {
      {"<scene", {"scene.xml:", "not well-formed XML"}},
      {"\n<shape type='cube'>", {"scene.xml:", "not well-formed XML"}},
      {"<teapot/>", {":2: <teapot>: this element is not known"}},
      {"\n\n<shape type='teapot'/>", {":4: <shape type=\"teapot\">", "use obj, ply, rectangle"}},
      {"<shape/>", {":2: <shape>", "attribute type is missing"}},
      {"<shape type='cube' colour='red'/>", {":2:", "attribute colour is not known"}},
      {"<shape type='cube' type='cube'/>", {":2:", "given twice"}},
      {"<shape type='cube'>words</shape>", {":2: <shape type=\"cube\">", "the text 'words'"}},
      {"<shape type='cube'>\n<float name='radius' value='1'/></shape>",
       {":3: <float name=\"radius\">", "not understood in <shape type=\"cube\">"}},
      {"<shape type='cube'><medium type='homogeneous' name='interior'/></shape>",
       {"<medium", "not understood"}},
      {"<shape type='sphere'><float name='radius' value='0'/></shape>", {"radius 0 should be above 0"}},
      {"<shape type='sphere'><float name='radius' value='1x'/></shape>",
       {":2: <float name=\"radius\">", "'1x'"}},
      {"<shape type='sphere'><float name='radius' value='nan'/></shape>", {"'nan' is not a finite number"}},
      {"<shape type='sphere'><string name='radius' value='1'/></shape>", {"wrong kind of value", "<float>"}},
      {"<shape type='sphere'><float name='radius' value='1'/><float name='radius' value='2'/></shape>",
       {"radius is given twice"}},
      {"<shape type='cylinder'><point name='p1' value='0 0'/></shape>", {"should be three numbers"}},
      {"<shape type='cylinder'><point name='p1' value='0 0 0'/></shape>", {"p0 and p1 coincide"}},
      {"<shape type='obj'/>", {"filename is missing"}},
      {"<shape type='obj'><string name='filename' value='no.obj'/></shape>",
       {":2: <shape", "no file 'no.obj'"}},
      {"<shape type='cube'><boolean name='flip_normals' value='yes'/></shape>", {"true or false"}},
      {"<shape type='cube'><bsdf type='diffuse'/><bsdf type='diffuse'/></shape>", {"more than one BSDF"}},
      {"<shape type='cube'><ref id='none'/></shape>", {":2: <ref id=\"none\">", "no object has this id"}},
      {"<shape type='cube' id='a'/>\n<shape type='cube' id='a'/>", {":3:", "already used", ":2"}},
      {"<shape type='cube'><emitter type='point'/></shape>", {"not an emitter for <shape type=\"cube\">"}},
      {"<shape type='$kind'/>", {":2: <shape type=\"$kind\">", "parameter $kind has no value", "-D kind="}},
      {"<include filename='gone.xml'/>", {":2: <include>", "no file 'gone.xml'"}},
      {"<shape type='cube'><transform name='to_world'>\n<scale value='0'/></transform></shape>",
       {":2: <transform", "singular"}},
      {"<shape type='cube'><transform name='to_world'>\n<rotate angle='4'/></transform></shape>",
       {":3: <rotate>"}},
      {"<shape type='cube'><transform name='to_world'><matrix value='1 2 3'/></transform></shape>",
       {"16 or 9"}},
      {"<shape type='cube'><transform name='to_world'><matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 "
       "1'/></transform>"
       "</shape>",
       {"last row must be 0 0 0 1"}},
      {"<shape type='cube'><transform name='to_world'>\n<lookat origin='0,0,0' target='0,0,0' "
       "up='0,1,0'/></transform>"
       "</shape>",
       {":3: <lookat>", "coincide"}},
      {"<shape type='cube'><transform name='to_world'><lookat origin='0,0,0' target='0,1,0' "
       "up='0,1,0'/></transform>"
       "</shape>",
       {"parallel"}},
      {"<shape type='cube'><transform name='to_world'><float name='a' value='1'/></transform></shape>",
       {"not an operation of a transform"}},
      {"\n<bsdf type='plastic' id='p'/>", {":3: <bsdf type=\"plastic\" id=\"p\">", "use diffuse, phong"}},
      {"<bsdf type='diffuse'><texture type='bitmap' name='reflectance'/></bsdf>",
       {"<texture type=\"bitmap\" name=\"reflectance\">", "textures are not supported"}},
      {"<bsdf type='diffuse'><rgb name='reflectance' value='1 2'/></bsdf>", {"not a colour"}},
      {"<bsdf type='diffuse'><rgb name='reflectance' value='#12345g'/></bsdf>", {"#rrggbb"}},
      {"<bsdf type='diffuse'><rgb name='reflectance' value='-1'/></bsdf>", {"negative"}},
      {"<bsdf type='diffuse'><spectrum name='reflectance' value='400:0.1, 700:0.2'/></bsdf>", {"'400:0.1'"}},
      {"<bsdf type='diffuse'><float name='roughness' value='1'/></bsdf>", {"<float name=\"roughness\">"}},
      {"<bsdf type='phong'><float name='exponent' value='-2'/></bsdf>", {"exponent -2"}},
      {"<bsdf type='roughconductor'/>", {"distribution beckmann is not supported", "ggx"}},
      {"<bsdf type='roughconductor'><string name='distribution' value='ggx'/><string name='material' "
       "value='Xx'/></bsdf>",
       {"'Xx' is not known", "Ag, Al, Au, Cr, Cu"}},
      {"<bsdf type='roughconductor'><string name='distribution' value='ggx'/><float name='alpha_u' "
       "value='.1'/>"
       "<float name='alpha_v' value='.2'/></bsdf>",
       {"anisotropy"}},
      {"<bsdf type='roughconductor'><string name='distribution' value='ggx'/><float name='alpha' "
       "value='0'/></bsdf>",
       {"roughness alpha 0"}},
      {"<bsdf type='roughconductor'><string name='distribution' value='ggx'/><rgb name='eta' "
       "value='1'/></bsdf>",
       {"eta and k belong together"}},
      {"<bsdf type='blendbsdf'><float name='weight' value='0.5'/><bsdf type='diffuse'/></bsdf>",
       {"1 nested BSDFs"}},
      {"<bsdf type='blendbsdf'><float name='weight' value='2'/><bsdf type='diffuse'/><bsdf "
       "type='phong'/></bsdf>",
       {"weight 2"}},
      {"<bsdf type='blendbsdf'><bsdf type='diffuse'/><bsdf type='phong'/></bsdf>", {"weight is missing"}},
      {"<bsdf type='blendbsdf'><float name='weight' value='.5'/><bsdf type='diffuse'/><bsdf type='twosided'>"
       "<bsdf type='diffuse'/></bsdf></bsdf>",
       {"one part is two-sided"}},
      {"<bsdf type='twosided'/>", {"no nested BSDF"}},
      {"<bsdf type='twosided' id='loop'><ref id='loop'/></bsdf>", {"may lead back to itself"}},
      {"<emitter type='envmap'/>", {"<emitter type=\"envmap\">", "use point, directional, constant"}},
      {"<emitter type='directional'><vector name='direction' value='0 0 0'/></emitter>",
       {"direction is zero"}},
      {"<emitter type='point'><point name='position' x='1'/><transform name='to_world'/></emitter>",
       {"exclude"}},
      {"<emitter type='constant'/>", {"a second constant emitter"}},
      {"<integrator type='path'><integer name='max_depth' value='2.5'/></integrator>", {"whole number"}},
      {"<integrator type='path'/><integrator type='path'/>", {"a second integrator"}},
      {"<integer name='seed' value='1'/>", {"<integer name=\"seed\">", "not understood in <scene>"}},
  };
  for (const Case& c : cases) {
    const std::string message = error_of(scene_text(c.body + kSquare));
    for (const std::string& fragment : c.fragments) EXPECT_THAT(message, HasSubstr(fragment)) << c.body;
    EXPECT_THAT(message, HasSubstr("scene.xml")) << c.body;
  }
}

TEST(Mitsuba, SensorErrors) {
  const std::pair<std::string, const char*> cases[] = {
      {"<float name='fov' value='180'/>", "fov 180"},
      {"<float name='fov' value='90'/><string name='fov_axis' value='z'/>", "fov_axis 'z'"},
      {"<float name='fov' value='90'/><string name='focal_length' value='50mm'/>", "exclude each other"},
      {"<string name='focal_length' value='long'/>", "focal_length 'long'"},
      {"<float name='aperture_radius' value='1'/>", "<float name=\"aperture_radius\">"},
      {film(0, 10), "width 0"},
      {film(10, 10, "<integer name='crop_width' value='4'/>"), "<integer name=\"crop_width\">"},
      {film(10, 10, "<rfilter type='tent'/>"), "use box or gaussian"},
      {film(10, 10, "<rfilter type='gaussian'><float name='stddev' value='0'/></rfilter>"), "stddev 0"},
      {"<film type='specfilm'/>", "use hdrfilm"},
      {"<sampler type='independent'><integer name='sample_count' value='0'/></sampler>", "1 or more"},
  };
  for (const auto& [content, message] : cases) {
    try {
      static_cast<void>(read_sensor(content));
      ADD_FAILURE() << content << " was accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(message));
    }
  }
  EXPECT_THAT(error_of("<scene version='3.0.0'>" + rectangle("") + "<sensor type='thinlens'/></scene>"),
              HasSubstr("use perspective"));
}

TEST(Mitsuba, WholeFileErrors) {
  EXPECT_THAT(error_of(""), HasSubstr("scene.xml:1"));
  EXPECT_THAT(error_of("<shape type='cube'/>"), HasSubstr("must be <scene>"));
  EXPECT_THAT(error_of("<scene version='3.0.0'/>"), HasSubstr("no shape"));
  EXPECT_THAT(error_of("<scene version='1.0.0'><shape type='cube'/></scene>"), HasSubstr("version '1.0.0'"));
  EXPECT_THAT(error_of("<scene>\n<shape type='cube'/>\n</shape>"), HasSubstr("scene.xml:3: not well-formed"));
  std::string deep = "<scene version='3.0.0'>";
  for (int i = 0; i < 5000; ++i) deep += "<bsdf type='twosided'>";
  for (int i = 0; i < 5000; ++i) deep += "</bsdf>";
  EXPECT_THAT(error_of(deep + "</scene>"), HasSubstr("nested more than"));
  for (const char* version : {"0.5.0", "0.6.0", "2.0.0", "3.5.2"}) {
    EXPECT_THAT(error_of(std::string("<scene version='") + version + "'><shape type='cube'/></scene>"),
                "no error");
  }
}

TEST(Mitsuba, LenientReadingWarnsAndSkips) {
  const SceneDescription scene = read_text(
      scene_text("<shape type='teapot'/>\n"
                 "<shape type='cube'><float name='what' value='1'/><bsdf type='plastic'/></shape>\n"
                 "<shape type='cube'><bsdf type='diffuse'>\n<texture type='bitmap' name='reflectance'>"
                 "<string name='filename' value='a.png'/></texture></bsdf></shape>\n"
                 "<emitter type='envmap'/><cloud/>"),
      lenient());
  EXPECT_THAT(scene.shapes, SizeIs(2));
  ASSERT_THAT(scene.warnings, SizeIs(6));
  EXPECT_THAT(scene.warnings,
              Contains(AllOf(HasSubstr(":2: <shape type=\"teapot\">"), HasSubstr("(skipped)"))));
  EXPECT_THAT(scene.warnings,
              Contains(AllOf(HasSubstr(":3: <float name=\"what\">"), HasSubstr("(skipped)"))));
  EXPECT_THAT(scene.warnings,
              Contains(AllOf(HasSubstr(":3: <bsdf type=\"plastic\">"), HasSubstr("diffuse 0.5"))));
  EXPECT_THAT(scene.warnings,
              Contains(AllOf(HasSubstr(":5: <texture type=\"bitmap\""), HasSubstr("grey 0.5"))));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr(":6: <emitter type=\"envmap\">")));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr(":6: <cloud>")));
  for (const ShapeDescription& shape : scene.shapes) {
    const Material& material = scene.materials.at(shape.materials.at(0));
    expect_color(std::get<LambertLobe>(material.lobes.at(0)).reflectance, Rgb::Constant(0.5f));
  }
  const SceneDescription filtered =
      read_text("<scene version='3.0.0'>" + rectangle("") + kLight + "<sensor type='perspective'>" +
                    film(8, 8, "<rfilter type='lanczos'/>") + "</sensor></scene>",
                lenient());
  EXPECT_EQ(filtered.film.filter, PixelFilter::kBox);
  EXPECT_THAT(filtered.warnings, ElementsAre(HasSubstr("box is used")));
}

TEST(Mitsuba, DamagedScenesAreReadOrRefused) {
  const std::filesystem::path scenes = std::filesystem::path(VRC_SOURCE_DIR) / "scenes";
  const std::string original = test::read_file(scenes / "glossy_pair.xml");
  constexpr std::string_view kBytes = "<>/\"'$#=-.,0919 \nxe!&";
  const test::TempDir dir;
  test::SeededBits bits(17);
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string text = original;
    for (int change = 0; change < 3; ++change) {
      const std::size_t at = bits.below(text.size());
      if (bits.below(2) == 0) {
        text[at] = kBytes[bits.below(kBytes.size())];
      } else {
        text.erase(at, bits.below(12));
      }
    }
    SceneReadOptions options;
    options.lenient = trial % 2 == 0;
    try {
      static_cast<void>(read_scene(test::write_file(dir / "scene.xml", text), options));
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("scene.xml"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

// The scenes of this repository.

TEST(Mitsuba, OwnScenesLoadCleanly) {
  const std::map<std::string, std::pair<int, int>> films = {
      {"pots", {640, 480}}, {"kitchen", {1024, 768}}, {"kitchen_pots", {640, 480}}, {"crown", {1280, 768}}};
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(VRC_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".xml") continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    const SceneDescription scene = read_scene(entry.path());
    EXPECT_THAT(scene.warnings, IsEmpty());
    EXPECT_THAT(scene.notes, IsEmpty());
    const auto film = films.find(entry.path().stem().string());
    const auto [width, height] = film == films.end() ? std::pair{512, 512} : film->second;
    EXPECT_EQ(scene.camera.width, width);
    EXPECT_EQ(scene.camera.height, height);
    EXPECT_EQ(scene.samples_per_pixel, 16);
    EXPECT_EQ(scene.max_depth, 3);
    EXPECT_EQ(scene.film.filter, PixelFilter::kBox);
    for (const ShapeDescription& shape : scene.shapes) {
      const Material& material = scene.materials.at(shape.materials.at(0));
      EXPECT_EQ(material.two_sided, shape.emission.at(0).maxCoeff() == 0.0f) << shape.id;
    }
  }
  EXPECT_GE(count, 5);
}

TEST(Mitsuba, OwnScenesFollowTheirParameters) {
  const std::filesystem::path scenes = std::filesystem::path(VRC_SOURCE_DIR) / "scenes";
  const auto wall = [&](const char* name) {
    const SceneDescription scene = read_scene(scenes / name);
    return scene.materials.at(scene.shapes.at(1).materials.at(0));
  };
  EXPECT_TRUE(std::holds_alternative<PhongLobe>(wall("glossy_pair.xml").lobes.at(0)));
  EXPECT_TRUE(std::holds_alternative<LambertLobe>(wall("glossy_pair_diffuse.xml").lobes.at(0)));

  SceneReadOptions options;
  options.defines = {{"metal", "Au"}, {"box_alpha", "0.02"}, {"width", "64"}, {"max_depth", "-1"}};
  const SceneDescription scene = read_scene(scenes / "cornell_ggx.xml", options);
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_EQ(scene.camera.width, 64);
  EXPECT_EQ(scene.max_depth, -1);
  for (const ShapeDescription& shape : scene.shapes) {
    if (shape.id != "tall") continue;
    const GgxLobe& lobe = std::get<GgxLobe>(scene.materials.at(shape.materials.at(0)).lobes.at(1));
    EXPECT_FLOAT_EQ(lobe.alpha, 0.02f);
    EXPECT_TRUE(lobe.has_fresnel);
  }
}

}  // namespace
}  // namespace vrc
