// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"

namespace vrc {

/// Numbers as 16-bit floats (IEEE 754 binary16) of value / 2^exponent. The largest value is put just below
/// the largest 16-bit float, so that values keep 11 bits down to 2^-28 of it; unless it is above 2^24 times
/// the median, when what is too large is cut off at 65504. Infinities and NaN stay.
struct HalfScale {
  int exponent = 0;

  explicit HalfScale(std::span<const float> values);
  [[nodiscard]] std::uint16_t operator()(float value) const;
};

/// A picture as a page holds it, before compression.
struct PackedPicture {
  int exponent = 0;
  /// The bits of G, and the differences to them of those of R and B, as integers that rise with the value;
  /// predicted from the left, upper and upper left neighbour (the median of left, upper, and left + upper -
  /// upper left); the residuals with the sign in the lowest bit. For each channel the high bytes of all
  /// pixels, then the low bytes. That is nothing but a way to make smooth pictures compress to a third.
  std::string bytes;
};

/// Of the channels R, G, B, which are the first three.
[[nodiscard]] PackedPicture pack_picture(const Image& picture);

/// The high bytes of all values, then the low bytes.
[[nodiscard]] std::string split_bytes(std::span<const std::uint16_t> values);

}  // namespace vrc
