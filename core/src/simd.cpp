// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simd.h"

namespace vrc {

F16 log2(F16 v) {
  // v = m 2^e with m in [sqrt(1/2), sqrt(2)); log2 m = 2/ln 2 atanh((m - 1)/(m + 1)), odd series.
  const I16 raw = bits(v);
  const I16 exponent = (raw - 0x3f3504f3) >> 23;
  const F16 m = from_bits(raw - (exponent << 23));
  const F16 z = (m - 1.0f) / (m + 1.0f);
  const F16 z2 = z * z;
  F16 series = splat(0.3205989f);  // (2 / ln 2) / (2 i + 1)
  series = series * z2 + 0.4121985f;
  series = series * z2 + 0.5770780f;
  series = series * z2 + 0.9617967f;
  series = series * z2 + 2.8853901f;
  return to_float(exponent) + z * series;
}

F16 exp2(F16 v) {
  const F16 clamped = min(max(v, -126.0f), 127.0f);
  const F16 whole = floor(clamped + 0.5f);
  const F16 f = clamped - whole;  // in [-1/2, 1/2]: Taylor series of exp(f ln 2)
  F16 series = splat(1.5252734e-5f);
  series = series * f + 1.5403530e-4f;
  series = series * f + 1.3333558e-3f;
  series = series * f + 9.6181291e-3f;
  series = series * f + 5.5504109e-2f;
  series = series * f + 2.4022651e-1f;
  series = series * f + 6.9314718e-1f;
  series = series * f + 1.0f;
  const F16 scale = from_bits((to_int(whole) + 127) << 23);
  return select(v < -126.0f, F16{}, series * scale);
}

SinCos16 sincos_2pi(F16 u) {
  // Reduce to a quarter turn around the nearest multiple of a quarter.
  const F16 quarter = floor(4.0f * u + 0.5f);
  const F16 x = (u - 0.25f * quarter) * 6.28318531f;  // in [-pi/4, pi/4]
  const F16 x2 = x * x;
  F16 s = splat(2.7557319e-6f);
  s = s * x2 - 1.9841270e-4f;
  s = s * x2 + 8.3333333e-3f;
  s = s * x2 - 1.6666667e-1f;
  s = s * x2 * x + x;
  F16 c = splat(2.4801587e-5f);
  c = c * x2 - 1.3888889e-3f;
  c = c * x2 + 4.1666667e-2f;
  c = c * x2 - 0.5f;
  c = c * x2 + 1.0f;
  const I16 q = to_int(quarter);
  const I16 swap = (q & 1) != 0;
  const F16 a = select(swap, c, s);
  const F16 b = select(swap, s, c);
  const I16 negate_sin = (q & 2) != 0;
  const I16 negate_cos = ((q + 1) & 2) != 0;
  return {select(negate_sin, -a, a), select(negate_cos, -b, b)};
}

F16 turns(F16 x, F16 y) {
  const F16 ax = max(x, -x), ay = max(y, -y);
  const F16 z = min(ax, ay) / max(max(ax, ay), 1e-37f);
  // atan(z) / (2 pi) on [0, 1]: odd polynomial, fitted for the least absolute error.
  const F16 z2 = z * z;
  F16 series = splat(1.0841215e-3f);
  series = series * z2 - 5.3482484e-3f;
  series = series * z2 + 1.2672464e-2f;
  series = series * z2 - 2.1061497e-2f;
  series = series * z2 + 3.1525113e-2f;
  series = series * z2 - 5.3026237e-2f;
  series = series * z2 + 1.5915433e-1f;
  F16 turn = z * series;
  turn = select(ay > ax, 0.25f - turn, turn);
  turn = select(x < 0.0f, 0.5f - turn, turn);
  turn = select(y < 0.0f, 1.0f - turn, turn);
  return select(turn < 1.0f, turn, F16{});
}

}  // namespace vrc
