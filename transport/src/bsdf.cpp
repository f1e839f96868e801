// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/bsdf.h"

#include <algorithm>
#include <numeric>

namespace vrc {
namespace {

/// As a Phong lobe's; 0 of a diffuse one.
float exponent_of(const Lobe& lobe) {
  if (const auto* phong = std::get_if<PhongLobe>(&lobe)) return phong->exponent;
  // A GGX lobe of half-vector width alpha is as narrow as a Phong lobe of exponent 1 / (2 alpha^2).
  if (const auto* ggx = std::get_if<GgxLobe>(&lobe)) return 0.5f / (ggx->alpha * ggx->alpha);
  return 0.0f;
}

}  // namespace

Bsdf::Bsdf(const Material& material) : two_sided(material.two_sided) {
  Material normalized = material;
  normalize_lobes(normalized);
  lobes = normalized.lobes;
  for (const Lobe& lobe : lobes) probabilities.push_back(strength(lobe));
  const float sum = std::accumulate(probabilities.begin(), probabilities.end(), 0.0f);
  for (float& p : probabilities) p /= sum;
}

float Bsdf::sharpness() const {
  float result = 0.0f;
  for (const Lobe& lobe : lobes) result = std::max(result, exponent_of(lobe));
  return result;
}

float Bsdf::weighted_sharpness() const {
  float result = 0.0f;
  for (std::size_t i = 0; i < lobes.size(); ++i)
    result = std::max(result, probabilities[i] * exponent_of(lobes[i]));
  return result;
}

Rgb Bsdf::albedo() const {
  Rgb sum = Rgb::Zero();
  for (const Lobe& lobe : lobes) sum += std::visit([](const auto& l) { return l.reflectance; }, lobe);
  return sum;
}

V3x16 f_cos(const Bsdf& bsdf, const Directions16& d) {
  V3x16 sum{};
  for (const Lobe& lobe : bsdf.lobes)
    std::visit([&](const auto& l) { sum += tint(l, d) * shape(l, d); }, lobe);
  return sum;
}

BsdfValue16 evaluate_bsdf(const std::vector<Bsdf>& bsdfs, I16 active, I16 material, const Directions16& d) {
  BsdfValue16 result{};
  for_each_distinct(active, material, [&](I16 mask, std::size_t id) {
    const Bsdf& bsdf = bsdfs[id];
    F16 density{};
    for (std::size_t i = 0; i < bsdf.lobes.size(); ++i)
      density +=
          bsdf.probabilities[i] * std::visit([&](const auto& lobe) { return pdf(lobe, d); }, bsdf.lobes[i]);
    result.f_cos = select(mask, f_cos(bsdf, d), result.f_cos);
    result.pdf = select(mask, density, result.pdf);
  });
  return result;
}

V3x16 sample_bsdf(const std::vector<Bsdf>& bsdfs, I16 active, I16 material, const V3x16& n, const V3x16& wo,
                  F16 u1, F16 u2) {
  V3x16 result{};
  for_each_distinct(active, material, [&](I16 mask, std::size_t id) {
    const Bsdf& bsdf = bsdfs[id];
    float begin = 0.0f;
    for (std::size_t i = 0; i < bsdf.lobes.size(); ++i) {
      const bool last = i + 1 == bsdf.lobes.size();
      const float end = last ? 1.0f : begin + bsdf.probabilities[i];
      const I16 chosen = mask & (u1 >= begin) & (u1 < end);
      if (any(chosen) && end > begin) {
        const F16 stretched = within_unit((u1 - begin) / (end - begin));
        std::visit(
            [&](const auto& lobe) { result = select(chosen, sample(lobe, n, wo, stretched, u2), result); },
            bsdf.lobes[i]);
      }
      begin = end;
    }
  });
  return result;
}

}  // namespace vrc
