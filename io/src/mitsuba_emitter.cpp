// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_emitter.h"

#include "core/error.h"

namespace vrc {
namespace {

PointLight read_point(const XmlElement& element, Properties& properties) {
  if (properties.has("position") && properties.has("to_world")) {
    fail(element, "position and to_world exclude each other; remove one");
  }
  PointLight light;
  const Mat4 to_world = properties.transform("to_world").value_or(Mat4::Identity());
  light.position = properties.vector("position").value_or(to_world.topRightCorner<3, 1>());
  light.intensity = properties.color("intensity").value_or(light.intensity);
  return light;
}

/// In its own frame the light travels along +z.
DirectionalLight read_directional(const XmlElement& element, Properties& properties) {
  if (properties.has("direction") && properties.has("to_world")) {
    fail(element, "direction and to_world exclude each other; remove one");
  }
  DirectionalLight light;
  const Mat4 to_world = properties.transform("to_world").value_or(Mat4::Identity());
  const Vec3 direction = properties.vector("direction").value_or(to_world.block<3, 1>(0, 2));
  if (!(direction.norm() > 0.0)) fail(element, "the direction is zero; give the way the light travels");
  light.direction = direction.normalized();
  light.irradiance = properties.color("irradiance").value_or(light.irradiance);
  return light;
}

}  // namespace

void add_emitter(const XmlElement& element, MitsubaContext& context, SceneDescription& scene) {
  Properties properties(element, context);
  const std::string_view type = element.get("type");
  if (type == "point") {
    scene.delta_lights.emplace_back(read_point(element, properties));
  } else if (type == "directional") {
    scene.delta_lights.emplace_back(read_directional(element, properties));
  } else if (type == "constant") {
    if (scene.environment.maxCoeff() > 0.0f) fail(element, "a second constant emitter; remove one");
    scene.environment = properties.color("radiance").value_or(Rgb::Ones());
  } else {
    context.report.reject(element,
                          "this emitter is not supported here; use point, directional, constant, or area "
                          "inside a shape");
    return;
  }
  properties.ignore({"sampling_weight"});
  properties.finish();
}

}  // namespace vrc
