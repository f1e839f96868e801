// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/sobol.h"

#include <array>
#include <mutex>

#include "core/error.h"
#include "core/hash.h"

namespace vrc {
namespace {

using Directions = std::array<std::uint32_t, 32>;

// Primitive polynomial (degree, coefficients) and initial values of dimensions 2 to 4 [JoeKuo2008].
struct Polynomial {
  int degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 3> initial;
};
constexpr std::array<Polynomial, 3> kPolynomials = {
    {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};

constexpr Directions make_directions(int dimension) {
  Directions v{};
  if (dimension == 0) {
    for (int i = 0; i < 32; ++i) v[i] = 1u << (31 - i);
    return v;
  }
  const Polynomial& p = kPolynomials[dimension - 1];
  for (int i = 0; i < p.degree; ++i) v[i] = p.initial[i] << (31 - i);
  for (int i = p.degree; i < 32; ++i) {
    v[i] = v[i - p.degree] ^ (v[i - p.degree] >> p.degree);
    for (int k = 1; k < p.degree; ++k) {
      if ((p.coefficients >> (p.degree - 1 - k)) & 1u) v[i] ^= v[i - k];
    }
  }
  return v;
}

constexpr std::array<Directions, kSobolDimensions> kDirections = {make_directions(0), make_directions(1),
                                                                  make_directions(2), make_directions(3)};

template <typename U>
U reverse_bits(U v) {
  v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v >> 8) & 0x00ff00ffu) | ((v & 0x00ff00ffu) << 8);
  return (v >> 16) | (v << 16);
}

// A hash in which every bit depends only on itself and lower bits: on reversed fractions it is a
// nested uniform scramble. Constants of [Burley2020].
template <typename U, typename Seed>
U scramble_reversed(U v, Seed seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

template <typename U, typename Seed>
U scramble(U fraction, Seed seed) {
  return reverse_bits(scramble_reversed(reverse_bits(fraction), seed));
}

/// Point `index` of the net for sixteen indices.
U16 sobol_lanes(U16 index, int dimension) {
  if (dimension == 0) return reverse_bits(index);
  U16 result{};
  const Directions& v = kDirections[dimension];
  for (int bit = 0; bit < 32; ++bit) {
    const U16 set = -((index >> bit) & 1u);
    if (bit >= 16 && !any(std::bit_cast<I16>(index >= splat(1u << bit)))) break;
    result ^= set & v[bit];
  }
  return result;
}

// Reversed points of the unscrambled sequence, shared by all nets.
const std::vector<std::uint32_t>& reversed_table(int dimension, int log2_count) {
  static std::array<std::array<std::vector<std::uint32_t>, 21>, kSobolDimensions> tables;
  static std::array<std::array<std::once_flag, 21>, kSobolDimensions> made;
  std::call_once(made[dimension][log2_count], [&] {
    auto& table = tables[dimension][log2_count];
    table.resize(std::size_t{1} << log2_count);
    for (std::uint32_t i = 0; i < table.size(); ++i) table[i] = reverse_bits(sobol(i, dimension));
  });
  return tables[dimension][log2_count];
}

/// Spreads the bits of a cell coordinate to even positions.
constexpr std::uint32_t spread_bits(std::uint32_t v) {
  v = (v | (v << 8)) & 0x00ff00ffu;
  v = (v | (v << 4)) & 0x0f0f0f0fu;
  v = (v | (v << 2)) & 0x33333333u;
  return (v | (v << 1)) & 0x55555555u;
}

}  // namespace

std::uint32_t sobol(std::uint32_t index, int dimension) {
  std::uint32_t result = 0;
  for (int bit = 0; index != 0; ++bit, index >>= 1) {
    if (index & 1u) result ^= kDirections[dimension][bit];
  }
  return result;
}

U16 owen_scramble(U16 fraction, std::uint32_t seed) { return scramble(fraction, seed); }
U16 owen_scramble(U16 fraction, U16 seed) { return scramble(fraction, seed); }
std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed) { return scramble(fraction, seed); }

Sample4 padded_sobol(U16 index, U16 seed) {
  // Shuffling the index by the same scramble keeps every aligned block of 2^k points a net.
  const U16 shuffled = scramble_reversed(reverse_bits(index), seed);
  const U16 point = reverse_bits(shuffled);
  Sample4 result;
  for (int d = 0; d < kSobolDimensions; ++d) {
    const U16 s = mix32(seed ^ (0x9e3779b9u * static_cast<std::uint32_t>(d + 1)));
    result.u[d] = to_unit_interval(scramble(sobol_lanes(point, d), s));
  }
  return result;
}

void fill_sobol_grid(SobolGrid& grid, int log2_count, std::uint64_t seed) {
  VRC_CHECK(log2_count >= 4 && log2_count <= 20, "{} points", log2_count);
  const std::size_t count = std::size_t{1} << log2_count;
  grid.columns_log2 = (log2_count + 1) / 2;
  grid.rows_log2 = log2_count / 2;
  for (auto& u : grid.u) u.resize(count);

  const std::uint32_t column_shift = 32u - static_cast<std::uint32_t>(grid.columns_log2);
  const std::uint32_t row_shift = 32u - static_cast<std::uint32_t>(grid.rows_log2);
  std::uint32_t seeds[kSobolDimensions];
  const std::uint32_t* tables[kSobolDimensions];
  for (int d = 0; d < kSobolDimensions; ++d) {
    seeds[d] = static_cast<std::uint32_t>(hash(seed, 0x50b01u, d));
    tables[d] = reversed_table(d, log2_count).data();
  }
  const auto block_seed = static_cast<std::uint32_t>(hash(seed, 0xb10cu));

  for (std::size_t begin = 0; begin < count; begin += kLanes) {
    U16 fraction[kSobolDimensions];
    for (int d = 0; d < kSobolDimensions; ++d) {
      U16 reversed;
      __builtin_memcpy(&reversed, tables[d] + begin, sizeof(reversed));
      fraction[d] = reverse_bits(scramble_reversed(reversed, seeds[d]));
    }
    const U16 column = fraction[0] >> column_shift;
    const U16 row = fraction[1] >> row_shift;
    for (int lane = 0; lane < kLanes; ++lane) {
      // Rows and columns differ by at most one bit: the surplus column bit leads.
      const std::uint32_t square = (1u << grid.rows_log2) - 1u;
      const std::uint32_t morton = spread_bits(column[lane] & square) | (spread_bits(row[lane]) << 1) |
                                   ((column[lane] >> grid.rows_log2) << (2 * grid.rows_log2));
      const std::uint32_t block = morton >> 4;
      const std::uint32_t permutation = ((block ^ block_seed) * 0x9e3779b1u) >> 28;
      const std::size_t slot = (std::size_t{block} << 4) | ((morton & 15u) ^ permutation);
      for (int d = 0; d < kSobolDimensions; ++d) {
        grid.u[d][slot] = static_cast<float>(fraction[d][lane] >> 8) * 0x1p-24f;
      }
    }
  }
}

}  // namespace vrc
