// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/simd.h"

namespace vrc {

inline constexpr int kSobolDimensions = 4;

/// Point `index` of dimension `dimension` of the Sobol sequence with the direction numbers of
/// [JoeKuo2008], as a 32-bit fraction.
[[nodiscard]] std::uint32_t sobol(std::uint32_t index, int dimension);

/// Owen's nested uniform scramble of a 32-bit fraction by hashing [LaineKarras2011, Burley2020].
[[nodiscard]] U16 owen_scramble(U16 fraction, std::uint32_t seed);
[[nodiscard]] U16 owen_scramble(U16 fraction, U16 seed);
[[nodiscard]] std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed);

/// Four coordinates in [0, 1) for each lane.
struct Sample4 {
  F16 u[kSobolDimensions];
};

/// Points `index` of a shuffled and Owen-scrambled four-dimensional Sobol sequence; `seed` differs
/// for every pixel and every group of dimensions, so groups can be padded [Burley2020].
[[nodiscard]] Sample4 padded_sobol(U16 index, U16 seed);

/// All 2^k points of one Owen-scrambled Sobol net, each in its own cell of a
/// columns x rows grid over the first two dimensions (columns * rows = 2^k).
///
/// Points are ordered by blocks of 4 x 4 cells along a Morton curve, so that sixteen neighbours make
/// a coherent ray packet; within a block the order is permuted at random, so that the sixteen lanes
/// are sixteen unbiased samples of the whole net, whose spread estimates the variance.
struct SobolGrid {
  int columns_log2 = 0;  ///< First dimension.
  int rows_log2 = 0;     ///< Second dimension.
  std::vector<float> u[kSobolDimensions];

  [[nodiscard]] std::size_t size() const { return u[0].size(); }
  /// The coordinates of the sixteen points from `first` on.
  [[nodiscard]] Sample4 packet(std::size_t first) const {
    Sample4 result;
    for (int d = 0; d < kSobolDimensions; ++d)
      __builtin_memcpy(&result.u[d], u[d].data() + first, sizeof(F16));
    return result;
  }
};

/// Fills `grid` (reusing its storage) with 2^log2_count points; 4 <= log2_count <= 20.
void fill_sobol_grid(SobolGrid& grid, int log2_count, std::uint64_t seed);

}  // namespace vrc
