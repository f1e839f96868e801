// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <complex>

#include "core/types.h"
#include "transport/material.h"

// The lobes as textbooks write them, in double precision: slow and obvious. Directions are unit
// vectors that point away from the surface.
namespace vrc::scalar {

inline Vec3 mirror(const Vec3& n, const Vec3& w) { return 2.0 * n.dot(w) * n - w; }
inline double tan2(double cosine) { return 1.0 / (cosine * cosine) - 1.0; }

/// Of normals; `cosine` is that of the microfacet's normal [Walter2007, eq. 33].
inline double ggx_distribution(double alpha, double cosine) {
  if (cosine <= 0.0) return 0.0;
  const double a2 = alpha * alpha, c4 = std::pow(cosine, 4);
  return a2 / (kPi * c4 * std::pow(a2 + tan2(cosine), 2));
}

/// Smith's auxiliary function [Heitz2014, eq. 72].
inline double ggx_lambda(double alpha, double cosine) {
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tan2(cosine)) - 1.0);
}

/// f cos_i without the lobe's colour.
inline double shape(const LambertLobe&, const Vec3& n, const Vec3& wo, const Vec3& wi) {
  return n.dot(wo) > 0.0 && n.dot(wi) > 0.0 ? n.dot(wi) / kPi : 0.0;
}
inline double shape(const PhongLobe& lobe, const Vec3& n, const Vec3& wo, const Vec3& wi) {
  if (n.dot(wo) <= 0.0 || n.dot(wi) <= 0.0) return 0.0;
  const double exponent = lobe.exponent, cosine = std::max(0.0, mirror(n, wi).dot(wo));
  return (exponent + 2.0) / (2.0 * kPi) * std::pow(cosine, exponent) * n.dot(wi);
}
inline double shape(const GgxLobe& lobe, const Vec3& n, const Vec3& wo, const Vec3& wi) {
  const double alpha = lobe.alpha, cos_o = n.dot(wo), cos_i = n.dot(wi);
  if (cos_o <= 0.0 || cos_i <= 0.0) return 0.0;
  const Vec3 h = (wo + wi).normalized();
  const double shadowing = 1.0 / (1.0 + ggx_lambda(alpha, cos_o) + ggx_lambda(alpha, cos_i));
  return ggx_distribution(alpha, n.dot(h)) * shadowing / (4.0 * cos_o * cos_i) * cos_i;
}

/// Densities of the samplers per solid angle.
inline double pdf(const LambertLobe&, const Vec3& n, const Vec3&, const Vec3& wi) {
  return std::max(0.0, n.dot(wi)) / kPi;
}
inline double pdf(const PhongLobe& lobe, const Vec3& n, const Vec3& wo, const Vec3& wi) {
  const double exponent = lobe.exponent;
  return (exponent + 1.0) / (2.0 * kPi) * std::pow(std::max(0.0, mirror(n, wo).dot(wi)), exponent);
}
/// That of visible normals, times the Jacobian of the reflection [Heitz2018].
inline double pdf(const GgxLobe& lobe, const Vec3& n, const Vec3& wo, const Vec3& wi) {
  const double alpha = lobe.alpha, cos_o = n.dot(wo);
  if (cos_o <= 0.0) return 0.0;
  const Vec3 h = (wo + wi).normalized();
  const double masking = 1.0 / (1.0 + ggx_lambda(alpha, cos_o)), oh = wo.dot(h);
  return masking * oh * ggx_distribution(alpha, n.dot(h)) / cos_o / (4.0 * oh);
}

/// Fresnel's equations with a complex index of refraction.
inline double conductor_fresnel(double cosine, double eta, double k) {
  const std::complex<double> index(eta, -k);
  const std::complex<double> cos_t = std::sqrt(1.0 - (1.0 - cosine * cosine) / (index * index));
  const auto rs = (cosine - index * cos_t) / (cosine + index * cos_t);
  const auto rp = (index * cosine - cos_t) / (index * cosine + cos_t);
  return 0.5 * (std::norm(rs) + std::norm(rp));
}

}  // namespace vrc::scalar
