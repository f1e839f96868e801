// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/hash.h"
#include "core/simd.h"
#include "core/types.h"

namespace vrc {

/// Independent uniform numbers, unlike the renderer's low-discrepancy ones; equal for equal seeds.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}

  double uniform() { return static_cast<double>(hash(seed_, counter_++) >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, 1) with 24 bits, as the renderer's samplers expect.
  float uniform24() { return static_cast<float>(hash(seed_, counter_++) >> 40) * 0x1p-24f; }
  F16 uniform16() {
    F16 v;
    for (int i = 0; i < kLanes; ++i) v[i] = uniform24();
    return v;
  }
  /// Uniform on the sphere.
  Vec3 direction() {
    const double z = uniform(-1.0, 1.0), phi = uniform(0.0, 2.0 * kPi), s = std::sqrt(1.0 - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
  }

 private:
  std::uint64_t seed_;
  std::uint64_t counter_ = 0;
};

inline Vec3 lane(const V3x16& v, int i) { return Vec3(v.x[i], v.y[i], v.z[i]); }
inline void set_lane(V3x16& v, int i, const Vec3& value) {
  v.x[i] = static_cast<float>(value.x());
  v.y[i] = static_cast<float>(value.y());
  v.z[i] = static_cast<float>(value.z());
}

/// A function of sixteen directions, such as a density per solid angle.
using DirectionFunction = std::function<F16(const V3x16&)>;

/// A grid on the sphere around an axis: rows in s, where 1 - cos(theta) = 2 s^power, so that a large
/// power resolves narrow lobes about the axis; columns in azimuth.
class SphereGrid {
 public:
  SphereGrid(const Vec3& axis, int power, int rows = 32, int columns = 32)
      : axis_(axis.normalized()), power_(power), rows_(rows), columns_(columns) {
    s_ = axis_.unitOrthogonal();
    t_ = axis_.cross(s_);
  }

  std::size_t size() const { return static_cast<std::size_t>(rows_) * columns_; }

  std::size_t cell(const Vec3& w) const {
    // 1 - cos from the difference of the vectors: accurate next to the axis.
    const double s = std::pow(0.25 * (w.normalized() - axis_).squaredNorm(), 1.0 / power_);
    const double turn = std::atan2(w.dot(t_), w.dot(s_)) / (2.0 * kPi) + 0.5;
    const auto index = [](double u, int n) { return std::clamp(static_cast<int>(u * n), 0, n - 1); };
    return static_cast<std::size_t>(index(s, rows_)) * columns_ + index(turn, columns_);
  }

  /// Integral of `f` over each cell by the midpoint rule on `parts` x `parts` points, a multiple of sixteen.
  std::vector<double> integrals(const DirectionFunction& f, int parts = 16) const {
    std::vector<double> result(size());
    for (int row = 0; row < rows_; ++row) {
      for (int part = 0; part < parts; ++part) {
        const double s = (row + (part + 0.5) / parts) / rows_;
        const double cosine = 1.0 - 2.0 * std::pow(s, power_);
        const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
        const double weight =
            2.0 * power_ * std::pow(s, power_ - 1) * 2.0 * kPi / (1.0 * parts * parts * rows_ * columns_);
        for (int part_column = 0; part_column < columns_ * parts; part_column += kLanes) {
          V3x16 w;
          for (int i = 0; i < kLanes; ++i) {
            const double phi = 2.0 * kPi * ((part_column + i + 0.5) / (columns_ * parts) - 0.5);
            set_lane(w, i, axis_ * cosine + sine * (std::cos(phi) * s_ + std::sin(phi) * t_));
          }
          const F16 value = f(w);
          double& sum = result[static_cast<std::size_t>(row) * columns_ + part_column / parts];
          for (int i = 0; i < kLanes; ++i) sum += weight * static_cast<double>(value[i]);
        }
      }
    }
    return result;
  }

  /// Over the whole sphere.
  double integral(const DirectionFunction& f, int parts = 16) const {
    double sum = 0.0;
    for (const double v : integrals(f, parts)) sum += v;
    return sum;
  }

 private:
  Vec3 axis_, s_, t_;
  int power_, rows_, columns_;
};

/// Probability that a chi-square variable exceeds `statistic`, by the cube root's near normality.
inline double chi_square_tail(double statistic, double degrees) {
  const double variance = 2.0 / (9.0 * degrees);
  const double z = (std::cbrt(statistic / degrees) - (1.0 - variance)) / std::sqrt(variance);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

struct ChiSquare {
  double p_value = 0.0;
  double total = 0.0;  ///< Integral of the density.
  double statistic = 0.0;
  int degrees = 0;
};

/// Tests counts of `samples` draws (those that made no direction are in no cell) against the
/// probabilities of the cells; cells that expect fewer than five draws are pooled.
inline ChiSquare chi_square_test(const std::vector<double>& counts, const std::vector<double>& probabilities,
                                 double samples) {
  ChiSquare result;
  double counted = 0.0, pooled_expected = 0.0, pooled_count = 0.0;
  const auto add = [&](double count, double expected) {
    result.statistic += (count - expected) * (count - expected) / expected;
    ++result.degrees;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    result.total += probabilities[i];
    counted += counts[i];
    const double expected = samples * probabilities[i];
    if (expected >= 5.0) {
      add(counts[i], expected);
    } else {
      pooled_expected += expected;
      pooled_count += counts[i];
    }
  }
  pooled_expected += samples * std::max(0.0, 1.0 - result.total);
  pooled_count += samples - counted;
  add(pooled_count, std::max(pooled_expected, 5.0));
  --result.degrees;
  result.p_value = chi_square_tail(result.statistic, result.degrees);
  return result;
}

/// The significance of each of `tests` tests that together raise a false alarm with
/// probability 0.001 (Sidak).
inline double sidak_level(int tests) { return 1.0 - std::pow(1.0 - 1e-3, 1.0 / tests); }

/// A running mean with its standard error.
class Estimate {
 public:
  void add(double v) {
    ++count_;
    const double delta = v - mean_;
    mean_ += delta / count_;
    squares_ += delta * (v - mean_);
  }
  double mean() const { return mean_; }
  double error() const { return std::sqrt(squares_ / (count_ * (count_ - 1.0))); }

 private:
  double count_ = 0.0, mean_ = 0.0, squares_ = 0.0;
};

/// Standard deviations between an estimate and a value, or between two estimates.
inline double z_score(const Estimate& a, double value) { return (a.mean() - value) / (a.error() + 1e-12); }
inline double z_score(const Estimate& a, const Estimate& b) {
  return (a.mean() - b.mean()) / (std::hypot(a.error(), b.error()) + 1e-12);
}

}  // namespace vrc
