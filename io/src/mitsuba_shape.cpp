// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_shape.h"

#include <algorithm>

#include "core/error.h"
#include "geometry/shapes.h"
#include "io/obj_reader.h"
#include "io/ply_reader.h"
#include "mesh_part.h"
#include "mitsuba_bsdf.h"

namespace vrc {
namespace {

std::filesystem::path mesh_path(const XmlElement& element, Properties& properties, MitsubaContext& context) {
  const std::optional<std::string> name = properties.string("filename");
  if (!name) fail(element, "the filename is missing; add <string name=\"filename\" value=\"...\"/>");
  context.files.push_back(resolve_file(element, *name, context.search_folders));
  return context.files.back();
}

double read_radius(const XmlElement& element, Properties& properties) {
  const double radius = properties.number("radius").value_or(1.0);
  if (!(radius > 0.0)) fail(element, fmt::format("the radius {:g} should be above 0", radius));
  return radius;
}

PolygonSoup read_cylinder(const XmlElement& element, Properties& properties) {
  const Vec3 p0 = properties.vector("p0").value_or(Vec3::Zero());
  const Vec3 p1 = properties.vector("p1").value_or(Vec3::UnitZ());
  if (!((p1 - p0).norm() > 0.0)) fail(element, "p0 and p1 coincide; move one of them");
  return make_cylinder(p0, p1, read_radius(element, properties));
}

/// As Mitsuba, which never reads the .mtl, when the shape has a BSDF or there is no .mtl.
MeshPart read_obj_shape(const std::filesystem::path& path, bool has_bsdf) {
  ObjFile obj = read_obj(path);
  const auto exists = [](const std::filesystem::path& library) {
    return std::filesystem::is_regular_file(library);
  };
  if (!has_bsdf && std::any_of(obj.material_libraries.begin(), obj.material_libraries.end(), exists)) {
    return part_from_obj(std::move(obj), path);
  }
  MeshPart part;
  part.shape.soup = std::move(obj.soup);
  part.warnings = std::move(obj.warnings);
  return part;
}

/// Geometry in the shape's own frame, with materials only if the mesh file brings them; nothing for
/// types that are not supported.
std::optional<MeshPart> read_local_part(const XmlElement& element, Properties& properties, bool has_bsdf,
                                        MitsubaContext& context) {
  const std::string_view type = element.get("type");
  MeshPart part;
  PolygonSoup& soup = part.shape.soup;
  if (type == "obj") {
    properties.ignore({"flip_tex_coords", "collapse"});
    return read_obj_shape(mesh_path(element, properties, context), has_bsdf);
  }
  if (type == "ply") {
    properties.ignore({"flip_tex_coords"});
    soup = read_ply(mesh_path(element, properties, context));
  } else if (type == "rectangle") {
    soup = make_rectangle();
  } else if (type == "cube") {
    soup = make_cube();
  } else if (type == "disk") {
    soup = make_disk();
  } else if (type == "sphere") {
    soup = make_sphere(properties.vector("center").value_or(Vec3::Zero()), read_radius(element, properties));
  } else if (type == "cylinder") {
    soup = read_cylinder(element, properties);
  } else {
    context.report.reject(element,
                          "this shape is not supported; use obj, ply, rectangle, cube, sphere, disk or "
                          "cylinder");
    return std::nullopt;
  }
  return part;
}

/// Turns faces and normals inside out.
void flip(PolygonSoup& soup) {
  for (std::size_t face = 0; face < soup.face_count(); ++face) {
    const auto reverse = [&](std::vector<std::uint32_t>& corners) {
      if (corners.empty()) return;
      std::reverse(corners.begin() + soup.face_begin[face], corners.begin() + soup.face_begin[face + 1]);
    };
    reverse(soup.corner_position);
    reverse(soup.corner_normal);
    reverse(soup.corner_uv);
  }
  for (Vec3& normal : soup.normals) normal = -normal;
}

/// Radiance of the nested area emitter.
std::optional<Rgb> read_emission(const XmlElement& element, Properties& properties, MitsubaContext& context) {
  std::optional<Rgb> radiance;
  for (const XmlElement* emitter : properties.objects("emitter")) {
    if (radiance) fail(*emitter, "a second emitter in one shape; remove one");
    if (emitter->get("type") != "area") {
      context.report.reject(*emitter, fmt::format("not an emitter for {}; use area", element.label()));
      continue;
    }
    Properties own(*emitter, context);
    radiance = own.color("radiance").value_or(Rgb::Ones());
    own.ignore({"sampling_weight"});
    own.finish();
  }
  return radiance;
}

}  // namespace

const Material& MaterialTable::read(const XmlElement& bsdf) {
  const auto known = read_.find(&bsdf);
  return known != read_.end() ? known->second : read_.emplace(&bsdf, read_bsdf(bsdf, context_)).first->second;
}

std::uint32_t MaterialTable::index(const XmlElement& bsdf) {
  const auto known = indices_.find(&bsdf);
  return known != indices_.end() ? known->second : indices_.emplace(&bsdf, add(read(bsdf))).first->second;
}

std::uint32_t MaterialTable::default_index() {
  if (!default_index_) default_index_ = add(default_material());
  return *default_index_;
}

std::uint32_t MaterialTable::add(Material material) {
  scene_.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene_.materials.size() - 1);
}

void add_shape(const XmlElement& element, MitsubaContext& context, MaterialTable& materials,
               SceneDescription& scene) {
  Properties properties(element, context);
  const std::vector<const XmlElement*> bsdfs = properties.objects("bsdf");
  if (bsdfs.size() > 1) fail(element, "more than one BSDF; remove the others or blend them");
  std::optional<MeshPart> part = read_local_part(element, properties, !bsdfs.empty(), context);
  if (!part) return;
  ShapeDescription& shape = part->shape;
  const std::optional<Rgb> emission = read_emission(element, properties, context);
  const std::optional<Mat4> to_world = properties.transform("to_world");
  const bool is_flipped = properties.boolean("flip_normals").value_or(false);
  shape.face_normals = properties.boolean("face_normals").value_or(false);
  properties.finish();

  if (to_world) transform(shape.soup, *to_world);
  if (is_flipped) flip(shape.soup);
  shape.soup.validate();
  shape.id =
      element.find("id") ? std::string(element.get("id")) : fmt::format("shape_{}", scene.shapes.size());
  if (part->materials.empty()) {
    shape.soup.face_material.clear();
    shape.materials = {bsdfs.empty() ? materials.default_index() : materials.index(*bsdfs.front())};
    shape.emission = {Rgb::Zero()};
  }
  if (emission) std::fill(shape.emission.begin(), shape.emission.end(), *emission);
  append(scene, std::move(*part));
}

}  // namespace vrc
