// SPDX-License-Identifier: GPL-3.0-or-later
// Notation: r = y - x, v = camera - x, S the shape operator, subscript t the tangential part.
// First and second derivatives by the tangent displacement d of x, by the turn m of its normal, and mixed:
//             d             d d                  m      d m    m m
//   n.r       0             S                    r_t    -I     -(n.r) I
//   n.v       0             S                    v_t    -I     -(n.v) I
//   r.r       -2 r_t        2 I + 2 (n.r) S      0
//   v.v       -2 v_t        2 I + 2 (n.v) S      0
//   r.v       -(r_t + v_t)  2 I + (n.r + n.v) S  0
//   a.r       -a_t          (a.n) S              0                      (a fixed)
#include "transport/lobe_jets.h"

namespace vrc {
namespace {

// Lobes are 0 at negative cosines, but their derivatives divide by the cosine: it is kept away from 0
// where the value is negligible, so that 0 times the derivative stays 0.
constexpr float kSmallestCosine = 1e-3f;

// Scalar jets with their values, for the sums inside GGX.
template <typename Jet>
struct ValueJet {
  F16 value;
  Jet j;  // divided by `value`
};

template <typename A, typename B>
ValueJet<A> multiply(const ValueJet<A>& a, const ValueJet<B>& b) {
  return {a.value * b.value, a.j * b.j};
}

template <typename Jet>
ValueJet<Jet> add(const ValueJet<Jet>& a, const ValueJet<Jet>& b) {
  return {a.value + b.value, weighted_sum(a.value, a.j, b.value, b.j)};
}

/// The GGX distribution from |h|^2 and n.h of the unnormalised half vector h = i + o:
/// D ~ |h|^4 / (|h|^2 - (1 - alpha^2) (n.h)^2)^2. `base` is that denominator's root, computed
/// without cancellation by the caller.
template <typename Jet>
Jet distribution_jet(float alpha, const ValueJet<UnitJet16>& h2, const ValueJet<Jet>& hn, F16 base) {
  const F16 inverse = 1.0f / max(base, 1e-20f);
  const F16 c = (1.0f - alpha * alpha) * hn.value * hn.value;
  const Jet base_jet = sum(scaled(h2.value * inverse, h2.j), scaled(-c * inverse, pow(hn.j, 2.0f)));
  return pow(base_jet, -2.0f) * pow(h2.j, 2.0f);
}

/// sqrt(alpha^2 + (1 - alpha^2) cosine^2) of `ggx_visibility`.
template <typename Jet>
ValueJet<Jet> masking_root(float alpha, const ValueJet<Jet>& cosine) {
  const F16 moving = (1.0f - alpha * alpha) * cosine.value * cosine.value;
  const F16 square = alpha * alpha + moving;
  return {sqrt(square), pow(scaled(moving / square, pow(cosine.j, 2.0f)), 0.5f)};
}

/// `ggx_visibility` = G2 / (4 cos_i cos_o).
template <typename Jet>
Jet visibility_jet(float alpha, const ValueJet<Jet>& i, const ValueJet<Jet>& o) {
  return pow(add(multiply(i, masking_root(alpha, o)), multiply(o, masking_root(alpha, i))).j, -1.0f);
}

/// Of n . a for a = r or v with tangential part (t1, t2).
template <typename Jet>
Jet normal_jet(const MovingPoint16& p, F16 value, F16 t1, F16 t2);
template <>
UnitJet16 normal_jet(const MovingPoint16& p, F16 value, F16, F16) {
  return unit_jet<F16>(1.0f / value, F16{}, F16{}, splat(p.s11), splat(p.s12), splat(p.s22));
}
template <>
TiltingJet16 normal_jet(const MovingPoint16& p, F16 value, F16 t1, F16 t2) {
  const F16 inverse = 1.0f / value;
  return {normal_jet<UnitJet16>(p, value, t1, t2),
          t1 * inverse,
          t2 * inverse,
          -inverse,
          F16{},
          F16{},
          -inverse,
          splat(-1.0f),
          F16{},
          splat(-1.0f)};
}

/// Of q = 2 (n.r)(n.v) - r.v.
template <typename Jet>
Jet mirrored_jet(const MovingPoint16& p, F16 inverse);
template <>
UnitJet16 mirrored_jet(const MovingPoint16& p, F16 inverse) {
  const F16 both = p.nr + p.nv;
  return unit_jet<F16>(inverse, p.r1 + p.v1, p.r2 + p.v2, both * p.s11 - 2.0f, both * p.s12,
                       both * p.s22 - 2.0f);
}
template <>
TiltingJet16 mirrored_jet(const MovingPoint16& p, F16 inverse) {
  const F16 twice = 2.0f * inverse;
  const F16 mixed = -twice * (p.nr + p.nv), product = -2.0f * p.nr * p.nv;
  return {mirrored_jet<UnitJet16>(p, inverse),
          twice * (p.nv * p.r1 + p.nr * p.v1),
          twice * (p.nv * p.r2 + p.nr * p.v2),
          mixed,
          F16{},
          F16{},
          mixed,
          twice * (product + 2.0f * p.r1 * p.v1),
          twice * (p.r1 * p.v2 + p.v1 * p.r2),
          twice * (product + 2.0f * p.r2 * p.v2)};
}

}  // namespace

MovingPoint16 moving_point(const RecordFrame& frame, const V3x16& r) {
  MovingPoint16 p;
  p.masking_moves = frame.masking_moves;
  const Eigen::Matrix2f& s = frame.shape_operator;
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

  const auto square_jet = [&](F16 value, F16 normal, F16 t1, F16 t2) {
    return unit_jet<F16>(2.0f / value, -t1, -t2, 1.0f + normal * p.s11, normal * p.s12,
                         1.0f + normal * p.s22);
  };
  p.jet_rr = square_jet(p.rr, p.nr, p.r1, p.r2);
  p.jet_vv = square_jet(p.vv, p.nv, p.v1, p.v2);
  return p;
}

template <typename Jet>
Jet jet_of_nr(const MovingPoint16& p) {
  return normal_jet<Jet>(p, p.nr, p.r1, p.r2);
}

template <typename Jet>
Jet jet_of_nv(const MovingPoint16& p) {
  return normal_jet<Jet>(p, p.nv, p.v1, p.v2);
}

template <typename Jet>
Jet shape_jet(const LambertLobe&, const MovingPoint16& p) {
  return jet_of_nr<Jet>(p);
}

template <typename Jet>
Jet shape_jet(const PhongLobe& lobe, const MovingPoint16& p) {
  // q / (|r| |v|) is the cosine of the lobe.
  const F16 q = max(2.0f * p.nr * p.nv - p.rv, kSmallestCosine * sqrt(p.rr * p.vv));
  return jet_of_nr<Jet>(p) * pow(mirrored_jet<Jet>(p, 1.0f / q), lobe.exponent) *
         pow(p.jet_rr * p.jet_vv, -0.5f * lobe.exponent);
}

template <typename Jet>
Jet shape_jet(const GgxLobe& lobe, const MovingPoint16& p) {
  const F16 inverse_r = 1.0f / sqrt(p.rr), inverse_v = 1.0f / sqrt(p.vv);
  const UnitJet16 jet_inverse_r = pow(p.jet_rr, -0.5f), jet_inverse_v = pow(p.jet_vv, -0.5f);
  const Jet jet_nr = jet_of_nr<Jet>(p);
  const ValueJet<Jet> in = {p.nr * inverse_r, jet_nr * jet_inverse_r};
  const ValueJet<Jet> on = {p.nv * inverse_v, jet_of_nv<Jet>(p) * jet_inverse_v};
  // 1 + i.o written with |r||v| + r.v, so that the unit jet never divides by r.v = 0.
  const F16 length_product = 1.0f / (inverse_r * inverse_v);
  const UnitJet16 jet_lengths = pow(p.jet_rr * p.jet_vv, 0.5f);
  const F16 one_plus = max(length_product + p.rv, 1e-6f * length_product);
  const F16 inverse = 1.0f / one_plus;
  const F16 hv = p.nr + p.nv;
  const UnitJet16 jet_one_plus = {(length_product * jet_lengths.g1 - p.r1 - p.v1) * inverse,
                                  (length_product * jet_lengths.g2 - p.r2 - p.v2) * inverse,
                                  (length_product * jet_lengths.h11 + 2.0f + hv * p.s11) * inverse,
                                  (length_product * jet_lengths.h12 + hv * p.s12) * inverse,
                                  (length_product * jet_lengths.h22 + 2.0f + hv * p.s22) * inverse};
  const auto h2 = multiply(ValueJet<UnitJet16>{2.0f * one_plus, jet_one_plus},
                           ValueJet<UnitJet16>{inverse_r * inverse_v, jet_inverse_r * jet_inverse_v});
  const ValueJet<Jet> hn = add(in, on);
  const F16 t1 = p.r1 * inverse_r + p.v1 * inverse_v, t2 = p.r2 * inverse_r + p.v2 * inverse_v;
  const F16 base = t1 * t1 + t2 * t2 + (lobe.alpha * lobe.alpha) * hn.value * hn.value;
  const Jet distribution = distribution_jet(lobe.alpha, h2, hn, base);
  if (p.masking_moves) return distribution * visibility_jet(lobe.alpha, in, on) * jet_nr;
  // shape |r| = D F G2 / (4 cos_o) |r|: the cosine at x cancels.
  return distribution * pow(p.jet_rr, 0.5f) * pow(on.j, -1.0f);
}

template UnitJet16 jet_of_nr(const MovingPoint16&);
template TiltingJet16 jet_of_nr(const MovingPoint16&);
template UnitJet16 jet_of_nv(const MovingPoint16&);
template TiltingJet16 jet_of_nv(const MovingPoint16&);
template UnitJet16 shape_jet(const LambertLobe&, const MovingPoint16&);
template TiltingJet16 shape_jet(const LambertLobe&, const MovingPoint16&);
template UnitJet16 shape_jet(const PhongLobe&, const MovingPoint16&);
template TiltingJet16 shape_jet(const PhongLobe&, const MovingPoint16&);
template UnitJet16 shape_jet(const GgxLobe&, const MovingPoint16&);
template TiltingJet16 shape_jet(const GgxLobe&, const MovingPoint16&);

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
  const ValueJet<UnitJet16> outgoing = {facing * inverse_r,
                                        jet_of_linear(p, facing, -y.n.x, -y.n.y, -y.n.z) * jet_inverse_r};
  const F16 length = p.rr * inverse_r;
  const UnitJet16 jet_length = pow(p.jet_rr, 0.5f);
  const F16 one_plus = max(length - y.light_r, 1e-6f * length);
  const F16 inverse = 1.0f / one_plus;
  const UnitJet16 jet_one_plus = {(length * jet_length.g1 + y.light.x) * inverse,
                                  (length * jet_length.g2 + y.light.y) * inverse,
                                  (length * jet_length.h11 - y.light.z * p.s11) * inverse,
                                  (length * jet_length.h12 - y.light.z * p.s12) * inverse,
                                  (length * jet_length.h22 - y.light.z * p.s22) * inverse};
  const auto h2 = multiply(ValueJet<UnitJet16>{2.0f * one_plus, jet_one_plus},
                           ValueJet<UnitJet16>{inverse_r, jet_inverse_r});
  const F16 hn = y.light_cos + outgoing.value;
  const ValueJet<UnitJet16> half = {hn, scaled(outgoing.value / hn, outgoing.j)};
  const V3x16 h = y.light - V3x16{p.r1, p.r2, p.nr} * inverse_r;
  const V3x16 tangential = h - y.n * hn;
  const F16 base = dot(tangential, tangential) + (lobe.alpha * lobe.alpha) * hn * hn;
  const UnitJet16 distribution = distribution_jet(lobe.alpha, h2, half, base);
  if (p.masking_moves)
    return distribution * visibility_jet(lobe.alpha, ValueJet<UnitJet16>{y.light_cos, {}}, outgoing);
  return distribution * pow(outgoing.j, -1.0f);
}

}  // namespace vrc
