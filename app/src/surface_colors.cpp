// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_colors.h"

#include <algorithm>
#include <cmath>

#include "io/color.h"

namespace vrc {
namespace {

/// OKLCH (hue in degrees) to linear sRGB, clamped to the gamut (OKLab, Ottosson 2020).
Rgb from_oklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue * kPi / 180.0), b = chroma * std::sin(hue * kPi / 180.0);
  const auto cube = [](double v) { return v * v * v; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  const Eigen::Array3d rgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                           -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                           -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s);
  return rgb.max(0.0).min(1.0).cast<float>();
}

}  // namespace

Rgb map_diverging(double value) {
  constexpr double kMiddleLightness = 0.93, kEndLightness = 0.45;
  constexpr double kBlueHue = 255.0, kOrangeHue = 55.0, kBlueChroma = 0.15, kOrangeChroma = 0.12;
  const double t = std::isnan(value) ? 0.0 : 2.0 * std::clamp(value, 0.0, 1.0) - 1.0;
  const double lightness = kMiddleLightness + (kEndLightness - kMiddleLightness) * std::abs(t);
  // Chroma first rises faster than lightness falls, so that small values already show their sign.
  const double saturation = std::abs(t) * (2.0 - std::abs(t));
  return t < 0.0 ? from_oklch(lightness, kBlueChroma * saturation, kBlueHue)
                 : from_oklch(lightness, kOrangeChroma * saturation, kOrangeHue);
}

Rgb part_color(std::uint32_t part) {
  constexpr double kGoldenAngle = 137.50776405003785;
  constexpr std::array<double, 3> kLightness{0.72, 0.55, 0.85};
  return from_oklch(kLightness[part % 3], 0.11, std::fmod(part * kGoldenAngle, 360.0));
}

std::array<std::uint8_t, 3> color8(const Rgb& linear) {
  return {quantize8(srgb_from_linear(linear[0])), quantize8(srgb_from_linear(linear[1])),
          quantize8(srgb_from_linear(linear[2]))};
}

}  // namespace vrc
