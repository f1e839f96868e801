// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/quadrature.h"

#include <cmath>

#include "core/error.h"

namespace vrc::sh {
namespace {

constexpr int kMaxNodes = 512;

struct LegendreJet {
  double value, derivative;
};

LegendreJet legendre_jet(int degree, double t) {
  std::vector<double> values(degree + 1);
  legendre(t, values);
  const double value = values[degree], before = values[degree - 1];
  return {value, degree * (before - t * value) / ((1.0 - t) * (1.0 + t))};
}

}  // namespace

void legendre(double t, std::span<double> out) {
  VRC_CHECK(!out.empty(), "no polynomials");
  out[0] = 1.0;
  if (out.size() > 1) out[1] = t;
  for (std::size_t l = 2; l < out.size(); ++l) {
    const auto n = static_cast<double>(l);
    out[l] = ((2.0 * n - 1.0) * t * out[l - 1] - (n - 1.0) * out[l - 2]) / n;
  }
}

Quadrature gauss_legendre(int count, double lower, double upper) {
  VRC_CHECK(count >= 1 && count <= kMaxNodes, "{} nodes are not in [1, {}]", count, kMaxNodes);
  VRC_CHECK(lower < upper, "empty interval [{}, {}]", lower, upper);
  const double centre = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
  Quadrature rule{std::vector<double>(count), std::vector<double>(count)};
  for (int i = 0; i < (count + 1) / 2; ++i) {
    // Tricomi's estimate of the zero, which Newton's method polishes in a few steps.
    const double n = count;
    double t = (1.0 - (n - 1.0) / (8.0 * n * n * n)) * std::cos(kPi * (i + 0.75) / (n + 0.5));
    LegendreJet jet = legendre_jet(count, t);
    for (int iteration = 0; iteration < 10 && std::abs(jet.value) > 1e-16 * std::abs(jet.derivative);
         ++iteration) {
      t -= jet.value / jet.derivative;
      jet = legendre_jet(count, t);
    }
    if (2 * i + 1 == count) t = 0.0;
    const double weight = 2.0 / ((1.0 - t) * (1.0 + t) * jet.derivative * jet.derivative);
    rule.nodes[i] = centre - half * t;
    rule.nodes[count - 1 - i] = centre + half * t;
    rule.weights[i] = rule.weights[count - 1 - i] = half * weight;
  }
  return rule;
}

SphereQuadrature sphere_quadrature(int degree) {
  VRC_CHECK(degree >= 0, "degree {} is negative", degree);
  const Quadrature heights = gauss_legendre(degree / 2 + 1);
  const int steps = degree + 1;
  SphereQuadrature rule;
  for (std::size_t i = 0; i < heights.nodes.size(); ++i) {
    const double z = heights.nodes[i], radius = std::sqrt((1.0 - z) * (1.0 + z));
    for (int k = 0; k < steps; ++k) {
      const double phi = 2.0 * kPi * (k + 0.5) / steps;
      rule.directions.emplace_back(radius * std::cos(phi), radius * std::sin(phi), z);
      rule.weights.push_back(heights.weights[i] * 2.0 * kPi / steps);
    }
  }
  return rule;
}

}  // namespace vrc::sh
