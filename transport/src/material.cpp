// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/material.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"

namespace vrc {
namespace {

Rgb& reflectance(Lobe& lobe) {
  return std::visit([](auto& model) -> Rgb& { return model.reflectance; }, lobe);
}

/// Exponent of the cosine lobe about the mirror direction that falls off like this one at its peak.
/// For GGX, D ~ exp(-tan^2 / alpha^2) there, and the half-vector turns by half the angle.
float sharpness(const Lobe& lobe) {
  if (const auto* phong = std::get_if<PhongLobe>(&lobe)) return phong->exponent;
  if (const auto* ggx = std::get_if<GgxLobe>(&lobe)) return 0.5f / (ggx->alpha * ggx->alpha);
  return -1.0f;  // Lambert comes first
}

}  // namespace

bool same_shape(const Lobe& a, const Lobe& b) {
  if (a.index() != b.index()) return false;
  if (const auto* phong = std::get_if<PhongLobe>(&a))
    return phong->exponent == std::get<PhongLobe>(b).exponent;
  if (const auto* ggx = std::get_if<GgxLobe>(&a)) {
    const GgxLobe& other = std::get<GgxLobe>(b);
    if (ggx->alpha != other.alpha || ggx->has_fresnel != other.has_fresnel) return false;
    return !ggx->has_fresnel || ((ggx->eta == other.eta).all() && (ggx->k == other.k).all());
  }
  return true;
}

void scale(Material& material, float weight) {
  for (Lobe& lobe : material.lobes) reflectance(lobe) *= weight;
}

void normalize_lobes(Material& material) {
  std::vector<Lobe> merged;
  for (Lobe& lobe : material.lobes) {
    if ((reflectance(lobe) == 0.0f).all()) continue;
    const auto equal = std::find_if(merged.begin(), merged.end(),
                                    [&](const Lobe& other) { return same_shape(lobe, other); });
    if (equal == merged.end()) {
      merged.push_back(lobe);
    } else {
      reflectance(*equal) += reflectance(lobe);
    }
  }
  std::vector<std::size_t> order(merged.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sharpness(merged[a]) < sharpness(merged[b]); });
  material.lobes.clear();
  for (const std::size_t index : order) material.lobes.push_back(merged[index]);
}

Material blend(const Material& a, const Material& b, float weight) {
  VRC_CHECK(weight >= 0.0f && weight <= 1.0f, "blend weight {}", weight);
  Material first = a;
  Material second = b;
  scale(first, 1.0f - weight);
  scale(second, weight);
  first.lobes.insert(first.lobes.end(), second.lobes.begin(), second.lobes.end());
  first.two_sided = a.two_sided || b.two_sided;
  normalize_lobes(first);
  return first;
}

}  // namespace vrc
