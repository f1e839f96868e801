// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"

namespace vrc {

/// One `newmtl` block of a Wavefront MTL file, as written.
struct MtlMaterial {
  std::string name;
  Rgb diffuse = Rgb::Constant(0.5f);  ///< Kd
  Rgb specular = Rgb::Zero();         ///< Ks
  Rgb emission = Rgb::Zero();         ///< Ke
  float shininess = 0.0f;             ///< Ns
  std::optional<float> roughness;     ///< Pr (PBR extension), in [0, 1]; GGX alpha is its square.
  std::optional<float> metallic;      ///< Pm (PBR extension), in [0, 1].
  std::vector<std::string> textures;  ///< Names of map_* statements, which are not used.
};

/// Throws InputError with file and line on malformed statements of the kinds above.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(const std::filesystem::path& path);

}  // namespace vrc
