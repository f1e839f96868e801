// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/lobes.h"

namespace vrc {
namespace {

I16 both_above(const Directions16& d) { return (d.cos_o > 0.0f) & (d.cos_i > 0.0f); }

V3x16 mirror(const V3x16& n, const V3x16& w) { return n * (2.0f * dot(n, w)) - w; }

F16 phong_cosine(const Directions16& d) { return 2.0f * d.cos_o * d.cos_i - dot(d.wo, d.wi); }

/// The projected hemisphere of visible normals seen from `stretched` [Heitz2018].
struct VisibleDisk {
  V3x16 t1, t2;
  F16 blend;  ///< Of the half disk towards the viewer.

  explicit VisibleDisk(const V3x16& stretched) {
    const F16 length2 = stretched.x * stretched.x + stretched.y * stretched.y;
    const F16 inverse = 1.0f / sqrt(max(length2, 1e-20f));
    const I16 tilted = length2 > 1e-14f;
    t1 = {select(tilted, -stretched.y * inverse, splat(1.0f)), select(tilted, stretched.x * inverse, F16{}),
          F16{}};
    t2 = cross(stretched, t1);
    blend = 0.5f * (1.0f + stretched.z);
  }
};

V3x16 stretched_view(const GgxLobe& lobe, const Tangents16& frame, const V3x16& n, const V3x16& wo) {
  return normalize({lobe.alpha * dot(wo, frame.s), lobe.alpha * dot(wo, frame.t), max(dot(wo, n), 1e-6f)});
}

/// Exact reflectance of a conductor for unpolarised light, per channel.
F16 conductor_fresnel(F16 cosine, float eta, float k) {
  const F16 cos2 = cosine * cosine;
  const F16 sin2 = 1.0f - cos2;
  const float eta2 = eta * eta, k2 = k * k;
  const F16 t0 = eta2 - k2 - sin2;
  const F16 a2b2 = sqrt(max(t0 * t0 + 4.0f * eta2 * k2, 0.0f));
  const F16 a = sqrt(max(0.5f * (a2b2 + t0), 0.0f));
  const F16 rs_sum = a2b2 + cos2, rs_product = 2.0f * cosine * a;
  const F16 rs = (rs_sum - rs_product) / (rs_sum + rs_product);
  const F16 rp_sum = cos2 * a2b2 + sin2 * sin2, rp_product = rs_product * sin2;
  const F16 rp = rs * (rp_sum - rp_product) / (rp_sum + rp_product);
  return 0.5f * (rs + rp);
}

}  // namespace

Tangents16 tangents(const V3x16& n) {
  const F16 sign = select(n.z < 0.0f, splat(-1.0f), splat(1.0f));
  const F16 a = -1.0f / (sign + n.z);
  const F16 b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

V3x16 around_axis(const V3x16& axis, F16 cos_theta, F16 u) {
  const F16 sin_theta = sqrt(max(1.0f - cos_theta * cos_theta, 0.0f));
  const SinCos16 phi = sincos_2pi(u);
  const Tangents16 frame = tangents(axis);
  return frame.s * (sin_theta * phi.cos) + frame.t * (sin_theta * phi.sin) + axis * cos_theta;
}

F16 ggx_distribution(float alpha, const Directions16& d) {
  const V3x16 h = d.wi + d.wo;
  const F16 hn = dot(h, d.n);
  const V3x16 tangential = h - d.n * hn;
  const F16 t2 = dot(tangential, tangential);
  const F16 h2 = hn * hn + t2;
  const F16 base = (alpha * alpha) * hn * hn + t2;
  return (alpha * alpha / kPiF) * (h2 * h2) / max(base * base, 1e-30f);
}

F16 ggx_visibility(float alpha, F16 cos_o, F16 cos_i) {
  const float a2 = alpha * alpha;
  const F16 lambda_o = cos_i * sqrt(a2 + (1.0f - a2) * cos_o * cos_o);
  const F16 lambda_i = cos_o * sqrt(a2 + (1.0f - a2) * cos_i * cos_i);
  return 0.5f / max(lambda_o + lambda_i, 1e-20f);
}

F16 shape(const LambertLobe&, const Directions16& d) {
  return select(both_above(d), d.cos_i * (1.0f / kPiF), F16{});
}
F16 shape(const PhongLobe& lobe, const Directions16& d) {
  const F16 value =
      pow(max(phong_cosine(d), 0.0f), lobe.exponent) * d.cos_i * ((lobe.exponent + 2.0f) / (2.0f * kPiF));
  return select(both_above(d), value, F16{});
}
F16 shape(const GgxLobe& lobe, const Directions16& d) {
  const F16 value = ggx_distribution(lobe.alpha, d) * ggx_visibility(lobe.alpha, d.cos_o, d.cos_i) * d.cos_i;
  return select(both_above(d), value, F16{});
}

V3x16 tint(const LambertLobe& lobe, const Directions16&) { return splat3(lobe.reflectance); }
V3x16 tint(const PhongLobe& lobe, const Directions16&) { return splat3(lobe.reflectance); }
V3x16 tint(const GgxLobe& lobe, const Directions16& d) {
  const V3x16 reflectance = splat3(lobe.reflectance);
  if (!lobe.has_fresnel) return reflectance;
  const V3x16 h = normalize(d.wi + d.wo);
  const F16 cosine = min(max(dot(h, d.wi), 0.0f), 1.0f);
  return reflectance * V3x16{conductor_fresnel(cosine, lobe.eta[0], lobe.k[0]),
                             conductor_fresnel(cosine, lobe.eta[1], lobe.k[1]),
                             conductor_fresnel(cosine, lobe.eta[2], lobe.k[2])};
}

F16 pdf(const LambertLobe&, const Directions16& d) { return max(d.cos_i, 0.0f) * (1.0f / kPiF); }
F16 pdf(const PhongLobe& lobe, const Directions16& d) {
  return pow(max(phong_cosine(d), 0.0f), lobe.exponent) * ((lobe.exponent + 1.0f) / (2.0f * kPiF));
}
F16 pdf(const GgxLobe& lobe, const Directions16& d) {
  const float a2 = lobe.alpha * lobe.alpha;
  const F16 masking = d.cos_o + sqrt(a2 + (1.0f - a2) * d.cos_o * d.cos_o);
  // Half vectors below the horizon are never sampled.
  const I16 up = (dot(d.wi + d.wo, d.n) > 0.0f) & (d.cos_o > 0.0f);
  return select(up, 0.5f * ggx_distribution(lobe.alpha, d) / max(masking, 1e-20f), F16{});
}

V3x16 sample(const LambertLobe&, const V3x16& n, const V3x16&, F16 u1, F16 u2) {
  return around_axis(n, sqrt(max(1.0f - u1, 0.0f)), u2);
}
V3x16 sample(const PhongLobe& lobe, const V3x16& n, const V3x16& wo, F16 u1, F16 u2) {
  const F16 cosine = pow(1.0f - u1, 1.0f / (lobe.exponent + 1.0f));
  return around_axis(normalize(mirror(n, wo)), min(cosine, 1.0f), u2);
}
V3x16 sample(const GgxLobe& lobe, const V3x16& n, const V3x16& wo, F16 u1, F16 u2) {
  // Visible normals: stretch, sample the projected disk, unstretch [Heitz2018].
  const Tangents16 frame = tangents(n);
  const V3x16 stretched = stretched_view(lobe, frame, n, wo);
  const VisibleDisk disk(stretched);
  const F16 radius = sqrt(u1);
  const SinCos16 phi = sincos_2pi(u2);
  const F16 p1 = radius * phi.cos;
  const F16 p2 = (1.0f - disk.blend) * sqrt(max(1.0f - p1 * p1, 0.0f)) + disk.blend * (radius * phi.sin);
  const V3x16 m = disk.t1 * p1 + disk.t2 * p2 + stretched * sqrt(max(1.0f - p1 * p1 - p2 * p2, 0.0f));
  const V3x16 local = normalize({lobe.alpha * m.x, lobe.alpha * m.y, max(m.z, 1e-6f)});
  const V3x16 h = frame.s * local.x + frame.t * local.y + n * local.z;
  return mirror(h, wo);
}

CosinePowerInverse::CosinePowerInverse(const LambertLobe&, const V3x16& n, const V3x16&)
    : axis_(n), frame_(tangents(n)), exponent_(1.0f) {}
CosinePowerInverse::CosinePowerInverse(const PhongLobe& lobe, const V3x16& n, const V3x16& wo)
    : axis_(normalize(mirror(n, wo))), frame_(tangents(axis_)), exponent_(lobe.exponent) {}
SampledFrom16 CosinePowerInverse::operator()(const V3x16& wi) const {
  const F16 cosine = max(dot(wi, axis_), 0.0f);
  const F16 power = exponent_ == 1.0f ? cosine : pow(cosine, exponent_);
  return {within_unit(1.0f - power * cosine), turns(dot(wi, frame_.s), dot(wi, frame_.t)),
          power * ((exponent_ + 1.0f) / (2.0f * kPiF))};
}

float CosinePowerInverse::cosine_at(float pdf) const {
  return std::pow(pdf * (2.0f * kPiF) / (exponent_ + 1.0f), 1.0f / exponent_);
}

GgxInverse::GgxInverse(const GgxLobe& lobe, const V3x16& n, const V3x16& wo)
    : lobe_(lobe), n_(n), wo_(wo), frame_(tangents(n)) {
  const VisibleDisk disk(stretched_view(lobe, frame_, n, wo));
  t1_ = disk.t1;
  t2_ = disk.t2;
  blend_ = disk.blend;
}
SampledFrom16 GgxInverse::operator()(const V3x16& wi) const {
  const V3x16 h = wo_ + wi;
  const float inverse = 1.0f / lobe_.alpha;
  const V3x16 m = normalize({inverse * dot(h, frame_.s), inverse * dot(h, frame_.t), max(dot(h, n_), 1e-6f)});
  const F16 p1 = dot(m, t1_);
  const F16 y = (dot(m, t2_) - (1.0f - blend_) * sqrt(max(1.0f - p1 * p1, 0.0f))) / blend_;
  return {within_unit(p1 * p1 + y * y), turns(p1, y), pdf(lobe_, directions(n_, wo_, wi))};
}

SampleInverse inverse_of_sample(const Lobe& lobe, const V3x16& n, const V3x16& wo) {
  if (const auto* phong = std::get_if<PhongLobe>(&lobe)) return CosinePowerInverse(*phong, n, wo);
  if (const auto* ggx = std::get_if<GgxLobe>(&lobe)) return GgxInverse(*ggx, n, wo);
  return CosinePowerInverse(LambertLobe{}, n, wo);
}

float strength(const Lobe& lobe) {
  return std::visit([](const auto& l) { return static_cast<float>(luminance(l.reflectance)); }, lobe);
}

}  // namespace vrc
