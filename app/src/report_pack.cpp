// SPDX-License-Identifier: GPL-3.0-or-later
#include "report_pack.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace vrc {
namespace {

constexpr float kLargestHalf = 65504.0f;
constexpr int kTopExponent = 14;  // of the largest value as it is stored
constexpr int kMedianDepth = 10;  // the median is stored as 2^-10 at least

/// Sign and magnitude become two's complement, so that order is kept.
std::int16_t ordered(std::uint16_t bits) {
  const int magnitude = bits & 0x7fff;
  return static_cast<std::int16_t>((bits & 0x8000) != 0 ? -magnitude : magnitude);
}

/// From the neighbours that come earlier.
int predicted(std::span<const std::int16_t> values, std::size_t index, int width) {
  const auto row = static_cast<std::size_t>(width);
  const bool first_column = index % row == 0;
  if (index < row) return first_column ? 0 : values[index - 1];
  if (first_column) return values[index - row];
  const int left = values[index - 1], up = values[index - row], corner = values[index - row - 1];
  return std::clamp(left + up - corner, std::min(left, up), std::max(left, up));
}

/// 0, -1, 1, -2 ... become 0, 1, 2, 3 ...; differences are those of 16-bit integers, which wrap.
std::uint16_t folded(int difference) {
  const auto wrapped = static_cast<std::int16_t>(difference);
  return static_cast<std::uint16_t>((wrapped * 2) ^ (wrapped < 0 ? -1 : 0));
}

std::string packed_channel(std::span<const std::int16_t> values, int width) {
  std::vector<std::uint16_t> residuals(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    residuals[i] = folded(values[i] - predicted(values, i, width));
  return split_bytes(residuals);
}

}  // namespace

HalfScale::HalfScale(std::span<const float> values) {
  std::vector<float> sizes;  // of what is neither zero nor infinite
  for (const float v : values) {
    if (std::isfinite(v) && v != 0.0f) sizes.push_back(std::abs(v));
  }
  if (sizes.empty()) return;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::ranges::nth_element(sizes, middle);
  exponent = std::min(std::ilogb(std::ranges::max(sizes)) - kTopExponent, std::ilogb(*middle) + kMedianDepth);
}

std::uint16_t HalfScale::operator()(float value) const {
  float scaled = std::ldexp(value, -exponent);
  if (std::isfinite(value)) scaled = std::clamp(scaled, -kLargestHalf, kLargestHalf);
  return Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(scaled));
}

std::string split_bytes(std::span<const std::uint16_t> values) {
  std::string bytes(2 * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i) {
    bytes[i] = static_cast<char>(values[i] >> 8);
    bytes[values.size() + i] = static_cast<char>(values[i] & 0xff);
  }
  return bytes;
}

PackedPicture pack_picture(const Image& picture) {
  VRC_CHECK(picture.channels.size() == 3, "{} channels", picture.channels.size());
  const HalfScale scale(picture.pixels);
  std::array<std::vector<std::int16_t>, 3> channels;
  for (std::size_t c = 0; c < 3; ++c) {
    channels[c].resize(picture.pixel_count());
    for (std::size_t p = 0; p < picture.pixel_count(); ++p)
      channels[c][p] = ordered(scale(picture.pixels[3 * p + c]));
  }
  auto& [red, green, blue] = channels;
  for (std::size_t p = 0; p < picture.pixel_count(); ++p) {
    red[p] = static_cast<std::int16_t>(red[p] - green[p]);
    blue[p] = static_cast<std::int16_t>(blue[p] - green[p]);
  }
  PackedPicture packed{scale.exponent, {}};
  for (const auto* channel : {&green, &red, &blue}) packed.bytes += packed_channel(*channel, picture.width);
  return packed;
}

}  // namespace vrc
