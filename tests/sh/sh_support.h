// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "core/types.h"
#include "sh/basis.h"

namespace vrc::test {

inline long double factorial(int n) {
  long double result = 1.0L;
  for (int i = 2; i <= n; ++i) result *= i;
  return result;
}

/// Y_lm in a unit direction, term by term from the derivatives of Rodrigues' formula.
inline double slow_harmonic(int l, int m, const Vec3& d) {
  const int a = std::abs(m);
  const long double z = d.z(), phi = std::atan2(static_cast<long double>(d.y()), d.x());
  long double sum = 0.0L;
  for (int k = 0; 2 * k <= l - a; ++k) {
    const int power = l - 2 * k - a;
    sum += (k % 2 == 0 ? 1.0L : -1.0L) * factorial(2 * l - 2 * k) /
           (factorial(k) * factorial(l - k) * factorial(power)) * std::pow(z, power);
  }
  const long double sine = std::hypot(static_cast<long double>(d.x()), d.y());
  const long double norm =
      std::sqrt((2 * l + 1) / (4.0L * std::acos(-1.0L)) * factorial(l - a) / factorial(l + a));
  const long double value = norm * std::pow(sine, a) * sum * std::pow(0.5L, l);
  if (m == 0) return static_cast<double>(value);
  return static_cast<double>(std::sqrt(2.0L) * value * (m > 0 ? std::cos(a * phi) : std::sin(a * phi)));
}

/// Random numbers of a fixed seed.
class ShRandom {
 public:
  explicit ShRandom(std::uint64_t seed) : engine_(seed) {}

  double normal() { return normal_(engine_); }
  Vec3 direction() { return Vec3(normal(), normal(), normal()).normalized(); }
  Mat3 rotation() {
    return Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized().toRotationMatrix();
  }
  Eigen::VectorXd coefficients(int order) {
    return Eigen::VectorXd::NullaryExpr(sh::coefficient_count(order), [&] { return normal(); });
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

/// `count` random directions, the six axes, and directions almost at the poles.
inline std::vector<Vec3> test_directions(int count) {
  ShRandom random(7);
  std::vector<Vec3> result;
  for (int i = 0; i < count; ++i) result.push_back(random.direction());
  for (int axis = 0; axis < 3; ++axis) {
    result.push_back(Vec3::Unit(axis));
    result.push_back(-Vec3::Unit(axis));
  }
  for (const double z : {1.0, -1.0}) {
    for (const double x : {1e-3, 1e-8, 1e-200}) result.push_back(Vec3(x, -2.0 * x, z).normalized());
  }
  return result;
}

inline Eigen::VectorXd harmonics(const sh::Basis& basis, const Vec3& d) {
  Eigen::VectorXd result(basis.size());
  basis.evaluate(d, {result.data(), static_cast<std::size_t>(result.size())});
  return result;
}

/// The function with these coefficients in a direction.
inline double function_value(const Eigen::VectorXd& coefficients, const Vec3& d) {
  return coefficients.dot(harmonics(sh::Basis(sh::order_of(coefficients.size())), d));
}

}  // namespace vrc::test
