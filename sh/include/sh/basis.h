// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/simd.h"
#include "core/types.h"

// Real spherical harmonics, orthonormal over the sphere, without the Condon-Shortley phase:
//   Y_lm = N_lm P_l^|m|(cos theta) cos(m phi) for m >= 0, ... sin(|m| phi) for m < 0,
// with P_1^1(cos theta) = +sin theta, so that Y_1,-1, Y_10, Y_11 = sqrt(3 / 4 pi) (y, z, x).
// Order L means the bands l = 0 .. L; coefficients are stored by `index(l, m)`.
namespace vrc::sh {

/// Orders above are refused: beyond 180 the recurrences would overflow in single precision.
inline constexpr int kMaxOrder = 128;

/// Position of Y_lm, l >= 0 and -l <= m <= l.
[[nodiscard]] constexpr int index(int l, int m) { return l * (l + 1) + m; }

/// Coefficients of the bands 0 .. order.
[[nodiscard]] constexpr int coefficient_count(int order) { return (order + 1) * (order + 1); }

/// Order of a vector of `count` coefficients; a logic_error if there is none up to kMaxOrder.
[[nodiscard]] int order_of(std::ptrdiff_t count);

/// Evaluates all Y_lm of an order by the recurrence over l for fixed m in Cartesian coordinates
/// [Sloan2013], with the normalisation in its constants: 2.5 operations a value, no trigonometry, and
/// exact at the poles. Const and thread-safe.
///
/// Directions must be unit vectors in the frame of the coefficients (not checked); `out` must hold
/// size() values, else a logic_error. Absolute errors up to order 30: 2e-13 in double, 5e-5 in single
/// precision, where most comes from rounding the direction.
class Basis {
 public:
  /// 0 <= order <= kMaxOrder, else a logic_error.
  explicit Basis(int order);

  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] int size() const { return coefficient_count(order_); }

  void evaluate(const Vec3& direction, std::span<double> out) const;
  void evaluate(const Vec3f& direction, std::span<float> out) const;
  /// Sixteen directions: out[stride * j] is coefficient j of each. Other places are left alone, and `out`
  /// may end after the last coefficient or later.
  void evaluate(const V3x16& directions, std::span<F16> out, std::ptrdiff_t stride = 1) const;

  /// Y_lm = a z Y_(l-1)m - b Y_(l-2)m.
  template <typename Real>
  struct Step {
    Real a, b;
  };
  template <typename Real>
  struct Recurrence {
    std::vector<Real> start;        ///< Y_mm / |x + i y|^m for each m.
    std::vector<Step<Real>> steps;  ///< l = m + 1 .. order for each m.
  };

 private:
  int order_;
  Recurrence<double> double_;
  Recurrence<float> single_;
};

/// All Y_lm in one unit direction; makes a `Basis`, so keep one where speed matters.
void evaluate(int order, const Vec3& direction, std::span<double> out);

}  // namespace vrc::sh
