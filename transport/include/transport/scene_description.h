// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/types.h"
#include "geometry/curvature.h"
#include "geometry/polygon_soup.h"
#include "transport/camera.h"
#include "transport/material.h"

namespace vrc {

/// One shape in world space, as readers produce it and `Scene` consumes it.
struct ShapeDescription {
  std::string id;
  PolygonSoup soup;                      ///< Already transformed to world space.
  std::vector<std::uint32_t> materials;  ///< soup.face_material -> SceneDescription::materials.
  std::vector<Rgb> emission;             ///< Parallel to `materials`: radiance emitted on the side of
                                         ///< the normal; zero for none.
  bool face_normals = false;             ///< true: ignore supplied normals, shade flat.
};

struct PointLight {
  Vec3 position = Vec3::Zero();
  Rgb intensity = Rgb::Ones();  ///< [W sr^-1]
};

struct DirectionalLight {
  Vec3 direction = -Vec3::UnitY();  ///< Unit; the way the light travels.
  Rgb irradiance = Rgb::Ones();     ///< On a surface that faces it. [W m^-2]
};

using DeltaLight = std::variant<PointLight, DirectionalLight>;

enum class PixelFilter { kBox, kGaussian };

struct FilmDescription {
  PixelFilter filter = PixelFilter::kBox;
  double gaussian_stddev = 0.5;  ///< In pixels; the support is four standard deviations.
};

/// Everything a scene file says, in memory, without acceleration structures.
struct SceneDescription {
  std::string source;
  std::vector<std::filesystem::path> files;  ///< That were read: the source, what it includes, meshes.
  std::vector<ShapeDescription> shapes;
  std::vector<Material> materials;
  std::vector<DeltaLight> delta_lights;
  Rgb environment = Rgb::Zero();  ///< Radiance of the `constant` emitter.
  Camera camera;
  FilmDescription film;
  double crease_angle = CreaseOptions{}.crease_angle;  ///< Where no normals are supplied. [degrees]
  CurvatureMethod curvature = CurvatureMethod::kFaceTensors;
  int samples_per_pixel = 16;
  int max_depth = -1;  ///< Mitsuba's count: 2 is direct light only, 3 adds one bounce; -1 is unbounded.

  std::vector<std::string> notes;     ///< What the reader chose by itself (camera, light).
  std::vector<std::string> warnings;  ///< What the reader had to leave out.
};

}  // namespace vrc
