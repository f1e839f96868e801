// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/image.h"

namespace vrc {

/// Constant that keeps relative errors finite in black regions; radiance squared, for pictures whose
/// mean luminance is about one half.
inline constexpr double kRelativeErrorOffset = 0.01;

/// Differences of an image I to a reference R, over all pixels and the channels red, green and blue.
/// Values that are not finite in either image are counted and left out of all other figures.
struct ImageError {
  double mse = 0.0;         ///< mean (I - R)^2
  double rmse = 0.0;        ///< sqrt(mse)
  double relmse = 0.0;      ///< mean (I - R)^2 / (R^2 + 0.01)
  double mean_ratio = 1.0;  ///< mean I / mean R; 1 when both are zero
  double max_abs = 0.0;     ///< max |I - R|
  std::size_t non_finite = 0;
};

/// Compares the channels R, G, B, or LAYER.R, LAYER.G, LAYER.B when `layer` is not empty.
/// Throws InputError when a channel is missing or the sizes differ.
[[nodiscard]] ImageError compare_rgb(const Image& image, const Image& reference, std::string_view layer = {});

/// mean (I - R1)(I - R2) / (R^2 + 0.01) with R = (R1 + R2) / 2, for two references of independent
/// noise: it cancels in the product, so the result may be slightly negative. Skewed noise does not cancel
/// quite: where both are too dark the product is positive and R small. Same channels and errors as
/// `compare_rgb`; values that are not finite are left out.
[[nodiscard]] double two_half_relmse(const Image& image, const Image& first_half, const Image& second_half,
                                     std::string_view layer = {});

/// (I - R1)(I - R2) / (R^2 + 0.01) over the channels R, G, B, pixel by pixel: an image with the one channel
/// "error". With an R of noise independent of the two halves' the noise of all cancels on average, however
/// skewed it is, up to a factor near one. Pixels that are not finite become NaN.
[[nodiscard]] Image two_half_error_map(const Image& image, const Image& first_half, const Image& second_half,
                                       const Image& reference);

/// Square root of the mean of (I - R)^2 / (R^2 + 0.01) over the three channels, pixel by pixel: an
/// image with the one channel "error". A pixel that is not finite in either image becomes NaN.
[[nodiscard]] Image relative_error_map(const Image& image, const Image& reference,
                                       std::string_view layer = {});

/// The values of a one-channel image below which these shares, in [0, 1], of its finite values lie: the
/// nearest one in rank; 0 without any.
[[nodiscard]] std::vector<double> percentiles(const Image& image, std::span<const double> shares);

/// The channels R, G, B, or those of `layer`, alone; named R, G, B.
[[nodiscard]] Image rgb_of(const Image& image, std::string_view layer = {});

/// All channels times a factor.
[[nodiscard]] Image scaled(Image image, float factor);

/// Of R, G and B, over all pixels.
[[nodiscard]] double mean_luminance(const Image& image);

/// The mean of two images of one size, channel by channel (R, G, B of `layer`; named R, G, B).
[[nodiscard]] Image mean_rgb(const Image& first, const Image& second, std::string_view layer = {});

/// Means over size x size pixels, all channels; blocks at the right and lower border may be smaller.
[[nodiscard]] Image block_means(const Image& image, int size);

/// The pixels [x0, x1) x [y0, y1), all channels. The window must lie inside the image.
[[nodiscard]] Image crop(const Image& image, int x0, int y0, int x1, int y1);

}  // namespace vrc
