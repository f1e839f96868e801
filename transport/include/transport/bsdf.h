// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "transport/lobes.h"

namespace vrc {

/// A material with the probabilities by which its lobes are sampled.
struct Bsdf {
  std::vector<Lobe> lobes;
  std::vector<float> probabilities;  ///< Parallel to `lobes`; sums to 1.
  bool two_sided = false;

  explicit Bsdf(const Material& material);
  /// Largest Phong-equivalent exponent of the lobes; 0 for a diffuse surface.
  [[nodiscard]] float sharpness() const;
  /// Largest product of a lobe's Phong-equivalent exponent and its share of what the surface reflects.
  [[nodiscard]] float weighted_sharpness() const;
  /// Sum of the lobes' reflectances.
  [[nodiscard]] Rgb albedo() const;
};

/// Calls body(mask, index) once for every distinct value of `ids` among the active lanes.
template <typename Body>
void for_each_distinct(I16 active, I16 ids, const Body& body) {
  for (std::uint32_t left = mask_bits(active); left != 0;) {
    const std::int32_t id = ids[std::countr_zero(left)];
    const I16 mask = active & (ids == id);
    body(mask, static_cast<std::size_t>(id));
    left &= ~mask_bits(mask);
  }
}

/// f cos_i, the sum over lobes.
[[nodiscard]] V3x16 f_cos(const Bsdf& bsdf, const Directions16& d);

struct BsdfValue16 {
  V3x16 f_cos;  ///< f cos_i; 0 in lanes without scattering.
  F16 pdf;      ///< Of sample_bsdf, per solid angle.
};

/// The sum over lobes, each lane with the material of its own.
[[nodiscard]] BsdfValue16 evaluate_bsdf(const std::vector<Bsdf>& bsdfs, I16 active, I16 material,
                                        const Directions16& d);

/// A direction by one lobe chosen with its probability; `u1` both chooses the lobe and, stretched,
/// samples it.
[[nodiscard]] V3x16 sample_bsdf(const std::vector<Bsdf>& bsdfs, I16 active, I16 material, const V3x16& n,
                                const V3x16& wo, F16 u1, F16 u2);

}  // namespace vrc
