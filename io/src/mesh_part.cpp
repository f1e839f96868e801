// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_part.h"

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "io/ply_reader.h"

namespace vrc {
namespace {

bool is_black(const Rgb& color) { return (color <= 0.0f).all(); }

/// Scales all lobes alike, so that no channel reflects more than it receives.
void limit_energy(Material& material, const std::string& file, std::vector<std::string>& warnings) {
  Rgb sum = Rgb::Zero();
  for (const Lobe& lobe : material.lobes) {
    sum += std::visit([](const auto& model) { return model.reflectance; }, lobe);
  }
  if (sum.maxCoeff() <= 1.0001f) return;
  warnings.push_back(fmt::format("{}: material '{}': diffuse and specular add up to {:.4g}; scaled down to 1",
                                 file, material.name, sum.maxCoeff()));
  scale(material, 1.0f / sum.maxCoeff());
}

std::vector<MtlMaterial> read_libraries(const std::vector<std::filesystem::path>& libraries,
                                        const std::string& file, std::vector<std::string>& warnings) {
  std::vector<MtlMaterial> all;
  for (const std::filesystem::path& library : libraries) {
    if (!std::filesystem::is_regular_file(library)) {
      warnings.push_back(fmt::format("{}: there is no material library '{}'; its materials become grey", file,
                                     library.string()));
      continue;
    }
    std::vector<MtlMaterial> materials = read_mtl(library);
    std::move(materials.begin(), materials.end(), std::back_inserter(all));
  }
  return all;
}

}  // namespace

Material stand_in_material() {
  Material material;
  material.name = "grey";
  material.lobes = {LambertLobe{Rgb::Constant(0.5f)}, PhongLobe{Rgb::Constant(0.1f), 30.0f}};
  material.two_sided = true;
  return material;
}

Material material_from_mtl(const MtlMaterial& mtl, const std::string& file,
                           std::vector<std::string>& warnings) {
  Rgb diffuse = mtl.diffuse.max(0.0f);
  const Rgb specular = mtl.specular.max(0.0f);
  if (!mtl.textures.empty()) {
    diffuse = Rgb::Constant(0.5f);
    warnings.push_back(
        fmt::format("{}: material '{}': textures are not supported ({}); diffuse grey 0.5 is used", file,
                    mtl.name, fmt::join(mtl.textures, ", ")));
  }

  Material material;
  material.name = mtl.name;
  material.two_sided = true;
  if (mtl.roughness) {
    const float metallic = mtl.metallic.value_or(0.0f);
    GgxLobe glossy;
    glossy.alpha = std::max(*mtl.roughness * *mtl.roughness, 1e-3f);
    glossy.reflectance = is_black(specular) ? Rgb(metallic * diffuse) : specular;
    material.lobes = {LambertLobe{(1.0f - metallic) * diffuse}, glossy};
  } else {
    material.lobes = {LambertLobe{diffuse}};
    if (mtl.shininess > 0.0f) material.lobes.push_back(PhongLobe{specular, mtl.shininess});
  }
  normalize_lobes(material);
  limit_energy(material, file, warnings);
  return material;
}

MeshPart part_from_obj(ObjFile obj, const std::filesystem::path& path) {
  const std::string file = path.string();
  MeshPart part;
  part.warnings = std::move(obj.warnings);
  part.shape.id = path.stem().string();
  part.shape.soup = std::move(obj.soup);
  const std::vector<MtlMaterial> library = read_libraries(obj.material_libraries, file, part.warnings);
  if (obj.material_names.empty()) obj.material_names.emplace_back();
  for (const std::string& name : obj.material_names) {
    const auto mtl =
        std::find_if(library.begin(), library.end(), [&](const MtlMaterial& m) { return m.name == name; });
    const bool is_known = mtl != library.end();
    if (!is_known && !name.empty()) {
      part.warnings.push_back(fmt::format("{}: material '{}' is not defined; grey is used", file, name));
    }
    part.shape.materials.push_back(static_cast<std::uint32_t>(part.materials.size()));
    part.shape.emission.push_back(is_known ? Rgb(mtl->emission.max(0.0f)) : Rgb(Rgb::Zero()));
    part.materials.push_back(is_known ? material_from_mtl(*mtl, file, part.warnings) : stand_in_material());
  }
  return part;
}

MeshPart read_ply_part(const std::filesystem::path& path) {
  MeshPart part;
  part.shape.id = path.stem().string();
  part.shape.soup = read_ply(path);
  part.shape.materials = {0};
  part.shape.emission = {Rgb::Zero()};
  part.materials = {stand_in_material()};
  return part;
}

void append(SceneDescription& scene, MeshPart part) {
  const auto offset = static_cast<std::uint32_t>(part.materials.empty() ? 0 : scene.materials.size());
  for (std::uint32_t& material : part.shape.materials) material += offset;
  std::move(part.materials.begin(), part.materials.end(), std::back_inserter(scene.materials));
  std::move(part.warnings.begin(), part.warnings.end(), std::back_inserter(scene.warnings));
  scene.shapes.push_back(std::move(part.shape));
}

}  // namespace vrc
