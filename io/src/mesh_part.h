// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/mtl_reader.h"
#include "io/obj_reader.h"
#include "transport/scene_description.h"

namespace vrc {

/// A mesh file as one shape with materials of its own.
struct MeshPart {
  ShapeDescription shape;  ///< `materials` indexes `MeshPart::materials`, or the scene's if that is empty.
  std::vector<Material> materials;
  std::vector<std::string> warnings;
};

/// For what has no material: two-sided diffuse 0.5 with a slight Phong gloss (0.1, exponent 30), so
/// that a view-dependent renderer has something to show.
[[nodiscard]] Material stand_in_material();

/// Two-sided. Kd and, where Ns > 0, Ks make Lambert + Phong; with Pr, GGX of alpha = max(Pr^2, 0.001)
/// with reflectance Ks (or, if black, metallic Kd) over a diffuse part (1 - metallic) Kd. The diffuse
/// colour of a textured material becomes grey 0.5. Lobes that add up to more than 1 are scaled down. What is
/// changed is told in `warnings`, prefixed by `file`.
[[nodiscard]] Material material_from_mtl(const MtlMaterial& mtl, const std::string& file,
                                         std::vector<std::string>& warnings);

/// An OBJ file, read from `path`, with its .mtl libraries; Ke > 0 becomes emission. A missing library
/// or material is a warning and gives the stand-in material. Throws InputError when a library is
/// malformed.
[[nodiscard]] MeshPart part_from_obj(ObjFile obj, const std::filesystem::path& path);

/// A PLY file, in the stand-in material.
[[nodiscard]] MeshPart read_ply_part(const std::filesystem::path& path);

/// Adds the part's shape, materials and warnings to the scene.
void append(SceneDescription& scene, MeshPart part);

}  // namespace vrc
