// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_scene.h"

#include "core/error.h"
#include "mesh_scene.h"
#include "mitsuba_emitter.h"
#include "mitsuba_sensor.h"
#include "mitsuba_shape.h"

namespace vrc {
namespace {

/// Children of the scene, sorted by what they are.
struct SceneParts {
  std::vector<const XmlElement*> sensors, integrators, emitters, bsdfs, shapes;
};

SceneParts sort_parts(const XmlElement& root, MitsubaContext& context) {
  SceneParts parts;
  Properties properties(root, context);
  parts.sensors = properties.objects("sensor");
  parts.integrators = properties.objects("integrator");
  parts.emitters = properties.objects("emitter");
  parts.bsdfs = properties.objects("bsdf");
  parts.shapes = properties.objects("shape");
  properties.finish();
  return parts;
}

void add_camera(const XmlElement& root, const SceneParts& parts, const SceneReadOptions& options,
                MitsubaContext& context, SceneDescription& scene) {
  if (parts.sensors.empty()) {
    frame_camera(scene, options);
    return;
  }
  read_sensor(*parts.sensors.front(), options, context, scene);
  if (parts.sensors.size() > 1) {
    context.report.note(fmt::format("{}: {} sensors; the first, {}, is used", root.file, parts.sensors.size(),
                                    parts.sensors.front()->label()));
  }
  if (options.camera_origin || options.camera_target || options.fov_degrees) {
    context.report.warn(
        fmt::format("{}: the camera options are left out, for the scene has a sensor", root.file));
  }
}

}  // namespace

SceneDescription read_mitsuba_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
  MitsubaReport report(options.lenient);
  const MitsubaXml xml = load_mitsuba_xml(path, options.defines, report);
  MitsubaContext context(xml, report);
  const SceneParts parts = sort_parts(xml.root, context);

  SceneDescription scene;
  scene.source = path.string();
  if (parts.integrators.size() > 1) fail(*parts.integrators[1], "a second integrator; remove one");
  if (!parts.integrators.empty()) scene.max_depth = read_max_depth(*parts.integrators.front(), context);
  MaterialTable materials(scene, context);
  for (const XmlElement* bsdf : parts.bsdfs) static_cast<void>(materials.read(*bsdf));
  for (const XmlElement* shape : parts.shapes) add_shape(*shape, context, materials, scene);
  if (scene.shapes.empty()) fail(xml.root, "the scene has no shape; add one");
  for (const XmlElement* emitter : parts.emitters) add_emitter(*emitter, context, scene);
  add_camera(xml.root, parts, options, context, scene);
  if (!has_emitter(scene)) add_stand_in_light(scene);

  scene.files = std::move(context.files);
  scene.notes.insert(scene.notes.end(), report.notes().begin(), report.notes().end());
  scene.warnings.insert(scene.warnings.end(), report.warnings().begin(), report.warnings().end());
  return scene;
}

}  // namespace vrc
