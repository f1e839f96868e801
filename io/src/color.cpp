// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/color.h"

#include <algorithm>
#include <cmath>

namespace vrc {
namespace {

/// Least-squares polynomials of degree 6 through a path in OKLCH: lightness 0.24 to 0.92, hue 305 to
/// 100 degrees, both linear in the value; chroma 0.145 or what the sRGB gamut allows. Lowest power
/// first; the values are encoded sRGB.
constexpr std::array<std::array<double, 7>, 3> kMap{{
    {0.1804, 0.9459, -16.3393, 68.4860, -137.1899, 135.3979, -50.5678},
    {-0.0114, 0.4482, 8.5733, -35.5824, 66.3992, -57.8941, 18.9799},
    {0.2822, 2.9073, -13.1168, 29.8949, -32.0293, 12.0680, 0.4263},
}};

double polynomial(const std::array<double, 7>& coefficients, double t) {
  double sum = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * t + *c;
  return sum;
}

std::array<float, 3> map_encoded(double value) {
  const double t = std::isnan(value) ? 0.0 : std::clamp(value, 0.0, 1.0);
  std::array<float, 3> encoded{};
  for (std::size_t c = 0; c < 3; ++c) {
    encoded[c] = static_cast<float>(std::clamp(polynomial(kMap[c], t), 0.0, 1.0));
  }
  return encoded;
}

}  // namespace

float srgb_from_linear(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float encoded) {
  const float x = std::clamp(encoded, 0.0f, 1.0f);
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

std::uint8_t quantize8(float value) {
  if (!(value > 0.0f)) return 0;  // also NaN
  return static_cast<std::uint8_t>(std::lround(std::min(value, 1.0f) * 255.0f));
}

Rgb map_color(double value) {
  const auto encoded = map_encoded(value);
  return {linear_from_srgb(encoded[0]), linear_from_srgb(encoded[1]), linear_from_srgb(encoded[2])};
}

std::array<std::uint8_t, 3> map_color8(double value) {
  const auto encoded = map_encoded(value);
  return {quantize8(encoded[0]), quantize8(encoded[1]), quantize8(encoded[2])};
}

}  // namespace vrc
