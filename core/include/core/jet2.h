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

/// The same of a scalar that depends on the normal, too, which turns by m besides: n + m, normalised. m has
/// two tangent components, without unit.
template <typename T>
struct TiltingJet {
  UnitJet<T> moved;              ///< By the displacement d, the normal staying.
  T n1{}, n2{};                  ///< Gradient by m.
  T x11{}, x12{}, x21{}, x22{};  ///< Second derivatives by d (first index) and m (second one).
  T m11{}, m12{}, m22{};         ///< Hessian by m.

  TiltingJet operator*(const TiltingJet& o) const {
    const UnitJet<T>&a = moved, &b = o.moved;
    return {a * b,
            n1 + o.n1,
            n2 + o.n2,
            x11 + o.x11 + T(a.g1 * o.n1 + n1 * b.g1),
            x12 + o.x12 + T(a.g1 * o.n2 + n2 * b.g1),
            x21 + o.x21 + T(a.g2 * o.n1 + n1 * b.g2),
            x22 + o.x22 + T(a.g2 * o.n2 + n2 * b.g2),
            m11 + o.m11 + T(2.0f * (n1 * o.n1)),
            m12 + o.m12 + T(n1 * o.n2 + n2 * o.n1),
            m22 + o.m22 + T(2.0f * (n2 * o.n2))};
  }
  /// With a factor that does not depend on the normal.
  TiltingJet operator*(const UnitJet<T>& o) const {
    return {
        moved * o, n1,  n2, x11 + T(n1 * o.g1), x12 + T(n2 * o.g1), x21 + T(n1 * o.g2), x22 + T(n2 * o.g2),
        m11,       m12, m22};
  }
};

/// The jet of f^p from the jet of f.
template <typename T>
[[nodiscard]] TiltingJet<T> pow(const TiltingJet<T>& j, float p) {
  const float pp = p * (p - 1.0f);
  const UnitJet<T>& d = j.moved;
  return {pow(d, p),
          p * j.n1,
          p * j.n2,
          p * j.x11 + pp * (d.g1 * j.n1),
          p * j.x12 + pp * (d.g1 * j.n2),
          p * j.x21 + pp * (d.g2 * j.n1),
          p * j.x22 + pp * (d.g2 * j.n2),
          p * j.m11 + pp * (j.n1 * j.n1),
          p * j.m12 + pp * (j.n1 * j.n2),
          p * j.m22 + pp * (j.n2 * j.n2)};
}

/// All entries times s.
template <typename S, typename T>
[[nodiscard]] UnitJet<T> scaled(const S& s, const UnitJet<T>& j) {
  return {j.g1 * s, j.g2 * s, j.h11 * s, j.h12 * s, j.h22 * s};
}
template <typename S, typename T>
[[nodiscard]] TiltingJet<T> scaled(const S& s, const TiltingJet<T>& j) {
  return {scaled(s, j.moved), j.n1 * s,  j.n2 * s,  j.x11 * s, j.x12 * s,
          j.x21 * s,          j.x22 * s, j.m11 * s, j.m12 * s, j.m22 * s};
}

/// The sum of two, entry by entry.
template <typename T>
[[nodiscard]] UnitJet<T> sum(const UnitJet<T>& a, const UnitJet<T>& b) {
  return {a.g1 + b.g1, a.g2 + b.g2, a.h11 + b.h11, a.h12 + b.h12, a.h22 + b.h22};
}
template <typename T>
[[nodiscard]] TiltingJet<T> sum(const TiltingJet<T>& a, const TiltingJet<T>& b) {
  return {sum(a.moved, b.moved), a.n1 + b.n1,   a.n2 + b.n2,   a.x11 + b.x11, a.x12 + b.x12,
          a.x21 + b.x21,         a.x22 + b.x22, a.m11 + b.m11, a.m12 + b.m12, a.m22 + b.m22};
}
template <typename T>
[[nodiscard]] TiltingJet<T> sum(const UnitJet<T>& a, const TiltingJet<T>& b) {
  TiltingJet<T> result = b;
  result.moved = sum(a, b.moved);
  return result;
}

/// The jet of (a f + b g) / (a + b) with a, b the values of f and g.
template <typename T, template <typename> typename Jet>
[[nodiscard]] Jet<T> weighted_sum(T a, const Jet<T>& f, T b, const Jet<T>& g) {
  const T inverse = 1.0f / (a + b);
  return sum(scaled(a * inverse, f), scaled(b * inverse, g));
}

/// With m = S d + tau, S the shape operator: derivatives by d and by tau, what the normal turns beyond S d.
/// `moved` becomes the total derivative along a surface that bends by S. With -S it goes back to d and m.
template <typename T, typename Scalar>
[[nodiscard]] TiltingJet<T> along_surface(const TiltingJet<T>& j, Scalar s11, Scalar s12, Scalar s22) {
  TiltingJet<T> r = j;
  r.x11 = j.x11 + j.m11 * s11 + j.m12 * s12;
  r.x12 = j.x12 + j.m12 * s11 + j.m22 * s12;
  r.x21 = j.x21 + j.m11 * s12 + j.m12 * s22;
  r.x22 = j.x22 + j.m12 * s12 + j.m22 * s22;
  const UnitJet<T>& d = j.moved;
  r.moved.g1 = d.g1 + j.n1 * s11 + j.n2 * s12;
  r.moved.g2 = d.g2 + j.n1 * s12 + j.n2 * s22;
  // H + X S + S X^T + S M S, with X + S M known.
  r.moved.h11 = d.h11 + (j.x11 + r.x11) * s11 + (j.x12 + r.x12) * s12;
  r.moved.h12 = d.h12 + j.x21 * s11 + j.x22 * s12 + r.x11 * s12 + r.x12 * s22;
  r.moved.h22 = d.h22 + (j.x21 + r.x21) * s12 + (j.x22 + r.x22) * s22;
  return r;
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
  Jet2 operator+(const Jet2& o) const {
    return {value + o.value, gradient + o.gradient, hessian + o.hessian};
  }
};
[[nodiscard]] inline Jet2 operator*(double s, const Jet2& j) {
  return {s * j.value, s * j.gradient, s * j.hessian};
}

}  // namespace vrc
