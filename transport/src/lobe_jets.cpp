// SPDX-License-Identifier: GPL-3.0-or-later
// Notation: r = y - x, v = camera - x, S the shape operator, subscript t the tangential part.
// First and second derivatives with respect to the tangent displacement d of x:
//   n.r   S r_t               -(n.r) S^2 - S
//   n.v   S v_t               -(n.v) S^2 - S
//   r.r   -2 r_t              2 I + 2 (n.r) S
//   v.v   -2 v_t              2 I + 2 (n.v) S
//   r.v   -(r_t + v_t)        2 I + (n.r + n.v) S
//   a.r   -a_t                (a.n) S                   (a fixed)
#include "transport/lobe_jets.h"

namespace vrc {
namespace {

// Lobes are 0 at negative cosines, but their derivatives divide by the cosine: it is kept away from 0
// where the value is negligible, so that 0 times the derivative stays 0.
constexpr float kSmallestCosine = 1e-3f;

// Scalar jets with their values, for the sums inside the GGX distribution.
struct ValueJet {
  F16 value;
  UnitJet16 j;  // divided by `value`
};

ValueJet multiply(const ValueJet& a, const ValueJet& b) { return {a.value * b.value, a.j * b.j}; }

ValueJet add(const ValueJet& a, const ValueJet& b) {
  return {a.value + b.value, weighted_sum<F16>(a.value, a.j, b.value, b.j)};
}

UnitJet16 scaled(F16 s, const UnitJet16& j) { return {s * j.g1, s * j.g2, s * j.h11, s * j.h12, s * j.h22}; }

/// The GGX distribution from |h|^2 and n.h of the unnormalised half vector h = i + o:
/// D ~ |h|^4 / (|h|^2 - (1 - alpha^2) (n.h)^2)^2. `base` is that denominator's root, computed
/// without cancellation by the caller.
UnitJet16 distribution_jet(float alpha, const ValueJet& h2, const ValueJet& hn, F16 base) {
  const F16 inverse = 1.0f / max(base, 1e-20f);
  const UnitJet16 hn2 = pow(hn.j, 2.0f);
  const F16 c = (1.0f - alpha * alpha) * hn.value * hn.value;
  const UnitJet16 a = scaled(h2.value * inverse, h2.j);
  const UnitJet16 b = scaled(-c * inverse, hn2);
  const UnitJet16 base_jet = {a.g1 + b.g1, a.g2 + b.g2, a.h11 + b.h11, a.h12 + b.h12, a.h22 + b.h22};
  return pow(h2.j, 2.0f) * pow(base_jet, -2.0f);
}

/// sqrt(alpha^2 + (1 - alpha^2) cosine^2) of `ggx_visibility`.
ValueJet masking_root(float alpha, const ValueJet& cosine) {
  const F16 moving = (1.0f - alpha * alpha) * cosine.value * cosine.value;
  const F16 square = alpha * alpha + moving;
  return {sqrt(square), pow(scaled(moving / square, pow(cosine.j, 2.0f)), 0.5f)};
}

/// `ggx_visibility` = G2 / (4 cos_i cos_o).
UnitJet16 visibility_jet(float alpha, const ValueJet& i, const ValueJet& o) {
  return pow(add(multiply(i, masking_root(alpha, o)), multiply(o, masking_root(alpha, i))).j, -1.0f);
}

}  // namespace

MovingPoint16 moving_point(const RecordFrame& frame, const V3x16& r) {
  MovingPoint16 p;
  p.masking_moves = frame.masking_moves;
  const Eigen::Matrix2f& s = frame.shape_operator;
  const Eigen::Matrix2f s2 = s * s;
  p.s11 = s(0, 0);
  p.s12 = s(0, 1);
  p.s22 = s(1, 1);
  p.r1 = dot(r, splat3(frame.tangent));
  p.r2 = dot(r, splat3(frame.bitangent));
  p.v1 = splat(frame.to_camera.dot(frame.tangent));
  p.v2 = splat(frame.to_camera.dot(frame.bitangent));
  p.nv = splat(frame.to_camera.dot(frame.normal));
  p.rr = dot(r, r);
  // Hits are seen from a lifted origin: one beside x can lie below its tangent plane by round-off.
  p.nr = max(dot(r, splat3(frame.normal)), 1e-6f * sqrt(p.rr));
  p.vv = splat(frame.to_camera.squaredNorm());
  p.rv = dot(r, splat3(frame.to_camera));

  const auto normal_jet = [&](F16 value, F16 t1, F16 t2) {
    return unit_jet<F16>(1.0f / value, p.s11 * t1 + p.s12 * t2, p.s12 * t1 + p.s22 * t2,
                         -value * s2(0, 0) - p.s11, -value * s2(0, 1) - p.s12, -value * s2(1, 1) - p.s22);
  };
  const auto square_jet = [&](F16 value, F16 normal, F16 t1, F16 t2) {
    return unit_jet<F16>(2.0f / value, -t1, -t2, 1.0f + normal * p.s11, normal * p.s12,
                         1.0f + normal * p.s22);
  };
  p.jet_nr = normal_jet(p.nr, p.r1, p.r2);
  p.jet_nv = normal_jet(p.nv, p.v1, p.v2);
  p.jet_rr = square_jet(p.rr, p.nr, p.r1, p.r2);
  p.jet_vv = square_jet(p.vv, p.nv, p.v1, p.v2);
  return p;
}

UnitJet16 shape_jet(const LambertLobe&, const MovingPoint16& p) { return p.jet_nr; }

UnitJet16 shape_jet(const PhongLobe& lobe, const MovingPoint16& p) {
  // q = 2 (n.r)(n.v) - r.v, so q / (|r| |v|) is the cosine of the lobe.
  const F16 q = max(2.0f * p.nr * p.nv - p.rv, kSmallestCosine * sqrt(p.rr * p.vv));
  const F16 sr1 = p.s11 * p.r1 + p.s12 * p.r2, sr2 = p.s12 * p.r1 + p.s22 * p.r2;
  const F16 sv1 = p.s11 * p.v1 + p.s12 * p.v2, sv2 = p.s12 * p.v1 + p.s22 * p.v2;
  const F16 g1 = 2.0f * (p.nv * sr1 + p.nr * sv1) + p.r1 + p.v1;
  const F16 g2 = 2.0f * (p.nv * sr2 + p.nr * sv2) + p.r2 + p.v2;
  const float s2_11 = p.s11 * p.s11 + p.s12 * p.s12;
  const float s2_12 = p.s12 * (p.s11 + p.s22);
  const float s2_22 = p.s12 * p.s12 + p.s22 * p.s22;
  const F16 squared = -4.0f * p.nr * p.nv;
  const F16 linear = -3.0f * (p.nr + p.nv);
  // S (r_t v_t^T + v_t r_t^T) S = (S r_t)(S v_t)^T + (S v_t)(S r_t)^T
  const F16 h11 = squared * s2_11 + linear * p.s11 + 4.0f * sr1 * sv1 - 2.0f;
  const F16 h12 = squared * s2_12 + linear * p.s12 + 2.0f * (sr1 * sv2 + sv1 * sr2);
  const F16 h22 = squared * s2_22 + linear * p.s22 + 4.0f * sr2 * sv2 - 2.0f;
  const UnitJet16 cosine = unit_jet<F16>(1.0f / q, g1, g2, h11, h12, h22);
  return p.jet_nr * pow(cosine, lobe.exponent) * pow(p.jet_rr * p.jet_vv, -0.5f * lobe.exponent);
}

UnitJet16 shape_jet(const GgxLobe& lobe, const MovingPoint16& p) {
  const F16 inverse_r = 1.0f / sqrt(p.rr), inverse_v = 1.0f / sqrt(p.vv);
  const UnitJet16 jet_inverse_r = pow(p.jet_rr, -0.5f), jet_inverse_v = pow(p.jet_vv, -0.5f);
  const ValueJet in = {p.nr * inverse_r, p.jet_nr * jet_inverse_r};
  const ValueJet on = {p.nv * inverse_v, p.jet_nv * jet_inverse_v};
  // 1 + i.o written with |r||v| + r.v, so that the unit jet never divides by r.v = 0.
  const F16 length_product = 1.0f / (inverse_r * inverse_v);
  const UnitJet16 jet_lengths = pow(p.jet_rr * p.jet_vv, 0.5f);
  const F16 one_plus = max(length_product + p.rv, 1e-6f * length_product);
  const F16 inverse = 1.0f / one_plus;
  const F16 hv = p.nr + p.nv;
  const UnitJet16 sum = {(length_product * jet_lengths.g1 - p.r1 - p.v1) * inverse,
                         (length_product * jet_lengths.g2 - p.r2 - p.v2) * inverse,
                         (length_product * jet_lengths.h11 + 2.0f + hv * p.s11) * inverse,
                         (length_product * jet_lengths.h12 + hv * p.s12) * inverse,
                         (length_product * jet_lengths.h22 + 2.0f + hv * p.s22) * inverse};
  const ValueJet h2 =
      multiply({2.0f * one_plus, sum}, {inverse_r * inverse_v, jet_inverse_r * jet_inverse_v});
  const ValueJet hn = add(in, on);
  const F16 t1 = p.r1 * inverse_r + p.v1 * inverse_v, t2 = p.r2 * inverse_r + p.v2 * inverse_v;
  const F16 base = t1 * t1 + t2 * t2 + (lobe.alpha * lobe.alpha) * hn.value * hn.value;
  const UnitJet16 distribution = distribution_jet(lobe.alpha, h2, hn, base);
  if (p.masking_moves) return distribution * visibility_jet(lobe.alpha, in, on) * p.jet_nr;
  // shape |r| = D F G2 / (4 cos_o) |r|: the cosine at x cancels.
  return distribution * pow(p.jet_rr, 0.5f) * pow(on.j, -1.0f);
}

UnitJet16 reflector_jet(const LambertLobe&, const FixedReflector16&, const MovingPoint16&) { return {}; }

UnitJet16 reflector_jet(const PhongLobe& lobe, const FixedReflector16& y, const MovingPoint16& p) {
  const V3x16 mirrored = y.n * (2.0f * y.light_cos) - y.light;
  const F16 q = max(y.light_r - 2.0f * y.light_cos * y.nr, kSmallestCosine * sqrt(p.rr));  // -mirrored . r
  const UnitJet16 cosine = jet_of_linear(p, q, -mirrored.x, -mirrored.y, -mirrored.z);
  return pow(cosine, lobe.exponent) * pow(p.jet_rr, -0.5f * lobe.exponent);
}

UnitJet16 reflector_jet(const GgxLobe& lobe, const FixedReflector16& y, const MovingPoint16& p) {
  const F16 inverse_r = 1.0f / sqrt(p.rr);
  const UnitJet16 jet_inverse_r = pow(p.jet_rr, -0.5f);
  const F16 facing = max(-y.nr, kSmallestCosine * sqrt(p.rr));
  const ValueJet outgoing = {facing * inverse_r,
                             jet_of_linear(p, facing, -y.n.x, -y.n.y, -y.n.z) * jet_inverse_r};
  const F16 length = p.rr * inverse_r;
  const UnitJet16 jet_length = pow(p.jet_rr, 0.5f);
  const F16 one_plus = max(length - y.light_r, 1e-6f * length);
  const F16 inverse = 1.0f / one_plus;
  const UnitJet16 sum = {(length * jet_length.g1 + y.light.x) * inverse,
                         (length * jet_length.g2 + y.light.y) * inverse,
                         (length * jet_length.h11 - y.light.z * p.s11) * inverse,
                         (length * jet_length.h12 - y.light.z * p.s12) * inverse,
                         (length * jet_length.h22 - y.light.z * p.s22) * inverse};
  const ValueJet h2 = multiply({2.0f * one_plus, sum}, {inverse_r, jet_inverse_r});
  const F16 hn = y.light_cos + outgoing.value;
  const ValueJet half = {hn, scaled(outgoing.value / hn, outgoing.j)};
  const V3x16 h = y.light - V3x16{p.r1, p.r2, p.nr} * inverse_r;
  const V3x16 tangential = h - y.n * hn;
  const F16 base = dot(tangential, tangential) + (lobe.alpha * lobe.alpha) * hn * hn;
  const UnitJet16 distribution = distribution_jet(lobe.alpha, h2, half, base);
  if (p.masking_moves) return distribution * visibility_jet(lobe.alpha, {y.light_cos, {}}, outgoing);
  return distribution * pow(outgoing.j, -1.0f);
}

}  // namespace vrc
