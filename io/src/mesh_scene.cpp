// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_scene.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "geometry/shapes.h"
#include "mesh_part.h"

namespace vrc {
namespace {

constexpr double kFovDegrees = 40.0;
const Vec3 kThreeQuarterView(0.55, 0.4, 1.0);  // from the target towards the camera
constexpr double kMargin = 1.05;

struct Sphere {
  Vec3 center;
  double radius;
};

/// About the middle of the bounding box; holds every vertex.
Sphere bounding_sphere(const SceneDescription& scene) {
  Box3 box;
  for (const ShapeDescription& shape : scene.shapes) box.extend(shape.soup.bounds());
  if (box.isEmpty()) throw InputError(scene.source, 0, "the scene is empty; give it a mesh with faces");
  const Vec3 center = box.center();
  double squared_radius = 0.0;
  for (const ShapeDescription& shape : scene.shapes) {
    for (const Vec3& position : shape.soup.positions) {
      squared_radius = std::max(squared_radius, (position - center).squaredNorm());
    }
  }
  if (!(squared_radius > 0.0))
    throw InputError(scene.source, 0, "all vertices coincide; the mesh has no extent");
  return {center, std::sqrt(squared_radius)};
}

std::string text(const Vec3& v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x(), v.y(), v.z()); }

Vec3 up_for(const Vec3& view) {
  return std::abs(view.y()) > 0.999 * view.norm() ? Vec3::UnitZ() : Vec3::UnitY();
}

}  // namespace

bool has_extension(const std::filesystem::path& path, std::string_view extension) {
  std::string own = path.extension().string();
  std::transform(own.begin(), own.end(), own.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return own == extension;
}

void frame_camera(SceneDescription& scene, const SceneReadOptions& options) {
  const Sphere bounds = bounding_sphere(scene);
  const double fov = options.fov_degrees.value_or(kFovDegrees);
  const int width = options.width.value_or(scene.camera.width);
  const int height = options.height.value_or(scene.camera.height);
  const double tan_half_width = std::tan(0.5 * fov * kPi / 180.0);
  const double half_angle = std::atan(tan_half_width * std::min(1.0, static_cast<double>(height) / width));
  const double distance = kMargin * bounds.radius / std::sin(half_angle);

  const Vec3 target = options.camera_target.value_or(bounds.center);
  const Vec3 origin = options.camera_origin.value_or(target + distance * kThreeQuarterView.normalized());
  scene.camera = look_at(origin, target, up_for(target - origin), fov, width, height);
  scene.notes.push_back(
      fmt::format("camera: the file has none; from {} to {}, field of view {:g} degrees, "
                  "{} x {} pixels",
                  text(origin), text(target), fov, width, height));
}

bool has_emitter(const SceneDescription& scene) {
  if (!scene.delta_lights.empty() || scene.environment.maxCoeff() > 0.0f) return true;
  return std::any_of(scene.shapes.begin(), scene.shapes.end(), [](const ShapeDescription& shape) {
    return std::any_of(shape.emission.begin(), shape.emission.end(),
                       [](const Rgb& radiance) { return radiance.maxCoeff() > 0.0f; });
  });
}

void add_stand_in_light(SceneDescription& scene) {
  // The light is as wide as 0.4 of the distance d to the target and 1.25 d from it: it lights a facing
  // surface with about 0.1 of its radiance, and it stands beside the camera, outside of the view.
  constexpr float kRadiance = 30.0f;
  constexpr float kSky = 0.1f;
  const Vec3 target = bounding_sphere(scene).center;
  const Camera& camera = scene.camera;
  double distance = (target - camera.origin).norm();
  if (!(distance > 0.0)) distance = bounding_sphere(scene).radius;
  const Vec3 position =
      camera.origin + distance * (0.1 * camera.forward - 0.45 * camera.right + 0.6 * camera.up);
  const Vec3 facing = (target - position).normalized();
  const Camera frame = look_at(position, position + facing, up_for(facing), 90.0, 1, 1);

  Mat4 to_world = Mat4::Identity();
  to_world.block<3, 4>(0, 0) << -0.2 * distance * frame.right, 0.2 * distance * frame.up, frame.forward,
      position;
  ShapeDescription light;
  light.id = "stand_in_light";
  light.soup = make_rectangle();
  transform(light.soup, to_world);
  light.materials = {static_cast<std::uint32_t>(scene.materials.size())};
  light.emission = {Rgb::Constant(kRadiance)};
  scene.materials.push_back({.name = "stand_in_light", .lobes = {}});
  scene.shapes.push_back(std::move(light));
  scene.environment = Rgb::Constant(kSky);
  scene.notes.push_back(
      fmt::format("light: the file has none; a square of side {:.4g} at {} facing {} with radiance "
                  "{:g}, and a sky of radiance {:g}",
                  0.4 * distance, text(position), text(target), kRadiance, kSky));
}

SceneDescription read_mesh_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
  SceneDescription scene;
  scene.source = path.string();
  scene.files = {path};
  for (const auto& [name, value] : options.defines) {
    scene.warnings.push_back(fmt::format("-D {}={}: a bare mesh has no parameters; left out", name, value));
  }
  append(scene, has_extension(path, ".obj") ? part_from_obj(read_obj(path), path) : read_ply_part(path));
  if (scene.shapes.front().soup.face_count() == 0) {
    throw InputError(scene.source, 0, "the mesh has no faces; points and lines cannot be rendered");
  }
  scene.max_depth = 3;
  frame_camera(scene, options);
  if (!has_emitter(scene)) add_stand_in_light(scene);
  return scene;
}

}  // namespace vrc
