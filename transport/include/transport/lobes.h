// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include "core/simd.h"
#include "transport/material.h"

namespace vrc {

/// A pair of directions at a surface point, sixteen at once. Both point away from the surface.
struct Directions16 {
  V3x16 n;   ///< Shading normal, on the side of wo.
  V3x16 wo;  ///< Towards the viewer.
  V3x16 wi;  ///< Towards the incident light.
  F16 cos_o, cos_i;
};

[[nodiscard]] inline Directions16 directions(const V3x16& n, const V3x16& wo, const V3x16& wi) {
  return {n, wo, wi, dot(n, wo), dot(n, wi)};
}

// Every lobe answers five questions. All lanes share the lobe's parameters.
//   shape:  f cos_i without the lobe's colour; 0 where either direction is below the surface
//   tint:   the colour that `shape` is multiplied by (reflectance, Fresnel)
//   pdf:    density of `sample` per solid angle
//   sample: a direction wi from two uniform numbers; it may lie below the surface (shape is 0 there)
//   (the jets of `shape` are in transport/lobe_jets.h)

[[nodiscard]] F16 shape(const LambertLobe& lobe, const Directions16& d);
[[nodiscard]] F16 shape(const PhongLobe& lobe, const Directions16& d);
[[nodiscard]] F16 shape(const GgxLobe& lobe, const Directions16& d);

[[nodiscard]] V3x16 tint(const LambertLobe& lobe, const Directions16& d);
[[nodiscard]] V3x16 tint(const PhongLobe& lobe, const Directions16& d);
[[nodiscard]] V3x16 tint(const GgxLobe& lobe, const Directions16& d);

[[nodiscard]] F16 pdf(const LambertLobe& lobe, const Directions16& d);
[[nodiscard]] F16 pdf(const PhongLobe& lobe, const Directions16& d);
[[nodiscard]] F16 pdf(const GgxLobe& lobe, const Directions16& d);

[[nodiscard]] V3x16 sample(const LambertLobe& lobe, const V3x16& n, const V3x16& wo, F16 u1, F16 u2);
[[nodiscard]] V3x16 sample(const PhongLobe& lobe, const V3x16& n, const V3x16& wo, F16 u1, F16 u2);
[[nodiscard]] V3x16 sample(const GgxLobe& lobe, const V3x16& n, const V3x16& wo, F16 u1, F16 u2);

/// Luminance of the lobe's reflectance: what lobes are chosen by.
[[nodiscard]] float strength(const Lobe& lobe);

struct Tangents16 {
  V3x16 s, t;
};
/// Two tangents of a unit vector [Duff2017].
[[nodiscard]] Tangents16 tangents(const V3x16& n);

/// The point (u1, u2) of the unit square, in [0, 1), from which `sample` makes a direction, and its pdf.
struct SampledFrom16 {
  F16 u1, u2, pdf;
};

// `sample` the other way round, for the directions wi at one point: what they share is found once. Directions
// that it never makes have pdf 0.
class CosinePowerInverse {
 public:
  CosinePowerInverse(const LambertLobe& lobe, const V3x16& n, const V3x16& wo);
  CosinePowerInverse(const PhongLobe& lobe, const V3x16& n, const V3x16& wo);
  [[nodiscard]] SampledFrom16 operator()(const V3x16& wi) const;
  [[nodiscard]] const V3x16& axis() const { return axis_; }
  /// Cosine with the axis of the directions that have this density per solid angle.
  [[nodiscard]] float cosine_at(float pdf) const;

 private:
  V3x16 axis_;
  Tangents16 frame_;
  float exponent_;
};
class GgxInverse {
 public:
  GgxInverse(const GgxLobe& lobe, const V3x16& n, const V3x16& wo);
  [[nodiscard]] SampledFrom16 operator()(const V3x16& wi) const;

 private:
  GgxLobe lobe_;
  V3x16 n_, wo_;
  Tangents16 frame_;
  V3x16 t1_, t2_;
  F16 blend_;
};
using SampleInverse = std::variant<CosinePowerInverse, GgxInverse>;
[[nodiscard]] SampleInverse inverse_of_sample(const Lobe& lobe, const V3x16& n, const V3x16& wo);

/// Direction at polar angle acos(cos_theta) and azimuth 2 pi u around `axis`.
[[nodiscard]] V3x16 around_axis(const V3x16& axis, F16 cos_theta, F16 u);

/// D and the squared sine-like terms of the GGX distribution for the unnormalised half vector
/// wi + wo, without cancellation near the normal [Walter2007].
[[nodiscard]] F16 ggx_distribution(float alpha, const Directions16& d);
/// Height-correlated Smith term G2 / (4 cos_i cos_o) [Heitz2014].
[[nodiscard]] F16 ggx_visibility(float alpha, F16 cos_o, F16 cos_i);

}  // namespace vrc
