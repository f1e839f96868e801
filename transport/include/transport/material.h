// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/types.h"

namespace vrc {

/// f = reflectance / pi.
struct LambertLobe {
  Rgb reflectance = Rgb::Constant(0.5f);
};

/// Normalised modified Phong: f = reflectance (N + 2) / (2 pi) max(0, cos a)^N, where a is the angle
/// between the outgoing and the mirrored incident direction.
struct PhongLobe {
  Rgb reflectance = Rgb::Constant(0.2f);
  float exponent = 30.0f;
};

/// Isotropic GGX microfacet conductor: f = reflectance D F G2 / (4 cos_i cos_o) with the
/// height-correlated Smith G2 and the exact conductor Fresnel term F of (eta, k), or F = 1.
struct GgxLobe {
  Rgb reflectance = Rgb::Ones();
  float alpha = 0.1f;
  bool has_fresnel = false;  ///< false: material "none", F = 1.
  Rgb eta = Rgb::Zero();     ///< Real part of the relative index of refraction.
  Rgb k = Rgb::Zero();       ///< Imaginary part, >= 0.
};

using Lobe = std::variant<LambertLobe, PhongLobe, GgxLobe>;

/// A BRDF as a sum of lobes; a blend is the concatenation of its parts' lobes with scaled
/// reflectances. An empty material is black.
struct Material {
  std::string name;
  std::vector<Lobe> lobes;
  bool two_sided = false;  ///< false: the back of the surface is black, as in Mitsuba.
};

/// Whether two lobes differ by their reflectances at most.
[[nodiscard]] bool same_shape(const Lobe& a, const Lobe& b);

/// Multiplies every lobe's reflectance by `weight`.
void scale(Material& material, float weight);

/// Merges lobes of equal shape (all Lambert lobes; Phong of equal exponent; equal GGX) and drops
/// black ones. The order of the result is Lambert first, then glossy lobes by rising sharpness
/// (the Phong exponent, or the one that falls off like GGX at its peak, 1 / (2 alpha^2)).
void normalize_lobes(Material& material);

/// `weight` in [0, 1] is the share of `b`. Lobes are normalised; the name is that of `a`; two-sided
/// when either is.
[[nodiscard]] Material blend(const Material& a, const Material& b, float weight);

}  // namespace vrc
