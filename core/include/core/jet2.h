// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/types.h"

namespace vrc {

/// Gradient and Hessian of f / f(0) for a scalar f of two tangent coordinates: the jet of a factor
/// whose value has been divided out. Products of factors become sums, so nothing large cancels.
/// T is double, float or F16. Units: 1/length and 1/length^2.
template <typename T>
struct UnitJet {
  T g1{}, g2{};
  T h11{}, h12{}, h22{};

  UnitJet operator*(const UnitJet& o) const {
    return {g1 + o.g1, g2 + o.g2, h11 + o.h11 + T(2.0f * (g1 * o.g1)), h12 + o.h12 + T(g1 * o.g2 + g2 * o.g1),
            h22 + o.h22 + T(2.0f * (g2 * o.g2))};
  }
};

/// The jet of f^p from the jet of f.
template <typename T>
[[nodiscard]] UnitJet<T> pow(const UnitJet<T>& j, float p) {
  const float pp = p * (p - 1.0f);
  return {p * j.g1, p * j.g2, p * j.h11 + pp * (j.g1 * j.g1), p * j.h12 + pp * (j.g1 * j.g2),
          p * j.h22 + pp * (j.g2 * j.g2)};
}

/// The jet of a factor with value `value`, gradient `g` and Hessian `h` (not yet divided).
template <typename T>
[[nodiscard]] UnitJet<T> unit_jet(T inverse_value, T g1, T g2, T h11, T h12, T h22) {
  return {g1 * inverse_value, g2 * inverse_value, h11 * inverse_value, h12 * inverse_value,
          h22 * inverse_value};
}

/// The jet of (a f + b g) / (a + b) with a, b the values of f and g.
template <typename T>
[[nodiscard]] UnitJet<T> weighted_sum(T a, const UnitJet<T>& f, T b, const UnitJet<T>& g) {
  const T inverse = 1.0f / (a + b);
  const T wa = a * inverse;
  const T wb = b * inverse;
  return {wa * f.g1 + wb * g.g1, wa * f.g2 + wb * g.g2, wa * f.h11 + wb * g.h11, wa * f.h12 + wb * g.h12,
          wa * f.h22 + wb * g.h22};
}

/// A scalar with its gradient and Hessian in the two tangent coordinates of a point:
/// f(d) = value + gradient . d + 1/2 d^T hessian d.
struct Jet2 {
  double value = 0.0;
  Vec2 gradient = Vec2::Zero();
  Mat2 hessian = Mat2::Zero();

  /// The Taylor polynomial of order 0, 1 or 2 at `d` [Zhao eq. 13].
  [[nodiscard]] double extrapolate(const Vec2& d, int order = 2) const {
    double result = value;
    if (order >= 1) result += gradient.dot(d);
    if (order >= 2) result += 0.5 * d.dot(hessian * d);
    return result;
  }
};

}  // namespace vrc
