// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/basis.h"

#include <cmath>

#include "core/error.h"

namespace vrc::sh {
namespace {

// Powers of sin theta below this are zero: single-precision arithmetic on denormal numbers is a
// hundred times slower, and no Y up to kMaxOrder multiplies them by more than 1e27.
constexpr float kTiny = 1e-36f;

double without_denormals(double v) { return v; }
float without_denormals(float v) { return std::abs(v) < kTiny ? 0.0f : v; }
F16 without_denormals(F16 v) { return select(abs(v) < kTiny, F16{}, v); }

/// The one recurrence, for double, float and sixteen floats.
template <typename Real, typename T>
void run(const Basis::Recurrence<Real>& recurrence, T x, T y, T z, T* out, std::ptrdiff_t stride) {
  const int order = static_cast<int>(recurrence.start.size()) - 1;
  const Basis::Step<Real>* step = recurrence.steps.data();
  T cosine = T{} + Real(1), sine = T{};  // sin^m(theta) times cos(m phi), sin(m phi)
  for (int m = 0; m <= order; ++m) {
    T* positive = out + stride * index(m, m);
    T* negative = out + stride * index(m, -m);
    T previous{}, value = T{} + recurrence.start[m];
    *negative = value * sine;  // First: for m = 0 both are one place.
    *positive = value * cosine;
    for (int l = m + 1; l <= order; ++l, ++step) {
      const T next = step->a * z * value - step->b * previous;
      previous = value;
      value = next;
      positive += stride * 2 * l;
      negative += stride * 2 * l;
      *negative = value * sine;
      *positive = value * cosine;
    }
    const T turned = x * cosine - y * sine;
    sine = without_denormals(x * sine + y * cosine);
    cosine = without_denormals(turned);
  }
}

Basis::Recurrence<double> make_recurrence(int order) {
  Basis::Recurrence<double> result;
  double start = std::sqrt(1.0 / (4.0 * kPi));
  for (int m = 0; m <= order; ++m) {
    if (m > 0) start *= std::sqrt((2.0 * m + 1.0) / (2.0 * m));
    result.start.push_back(m == 0 ? start : std::sqrt(2.0) * start);
    for (int l = m + 1; l <= order; ++l) {
      const double square = static_cast<double>(l) * l - static_cast<double>(m) * m;
      const double before = (l - 1.0) * (l - 1.0) - static_cast<double>(m) * m;
      result.steps.push_back({std::sqrt((4.0 * l * l - 1.0) / square),
                              std::sqrt((2.0 * l + 1.0) * before / (std::abs(2.0 * l - 3.0) * square))});
    }
  }
  return result;
}

Basis::Recurrence<float> to_single(const Basis::Recurrence<double>& recurrence) {
  Basis::Recurrence<float> result;
  for (const double start : recurrence.start) result.start.push_back(static_cast<float>(start));
  for (const auto& step : recurrence.steps)
    result.steps.push_back({static_cast<float>(step.a), static_cast<float>(step.b)});
  return result;
}

int checked_order(int order) {
  VRC_CHECK(order >= 0 && order <= kMaxOrder, "order {} is not in [0, {}]", order, kMaxOrder);
  return order;
}

void check_size(std::size_t size, std::ptrdiff_t expected) {
  VRC_CHECK(static_cast<std::ptrdiff_t>(size) == expected, "{} values where there must be {}", size,
            expected);
}

}  // namespace

int order_of(std::ptrdiff_t count) {
  for (int order = 0; order <= kMaxOrder; ++order) {
    if (coefficient_count(order) == count) return order;
  }
  VRC_CHECK(false, "{} is not a number of coefficients", count);
}

Basis::Basis(int order)
    : order_(checked_order(order)), double_(make_recurrence(order)), single_(to_single(double_)) {}

void Basis::evaluate(const Vec3& d, std::span<double> out) const {
  check_size(out.size(), size());
  run(double_, d.x(), d.y(), d.z(), out.data(), 1);
}

void Basis::evaluate(const Vec3f& d, std::span<float> out) const {
  check_size(out.size(), size());
  run(single_, d.x(), d.y(), d.z(), out.data(), 1);
}

void Basis::evaluate(const V3x16& d, std::span<F16> out, std::ptrdiff_t stride) const {
  VRC_CHECK(stride >= 1 && std::ssize(out) > stride * (size() - 1), "{} places for {} coefficients {} apart",
            out.size(), size(), stride);
  run(single_, d.x, d.y, d.z, out.data(), stride);
}

void evaluate(int order, const Vec3& direction, std::span<double> out) {
  Basis(order).evaluate(direction, out);
}

}  // namespace vrc::sh
