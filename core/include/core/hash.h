// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace vrc {

/// A bijective mixer of 64 bits (the finaliser of SplitMix64).
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15ull;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
  return v ^ (v >> 31);
}

/// A bijective mixer of 32 bits, of a number or of lanes of them (lowbias32 of [Wellons2018]).
template <typename U>
[[nodiscard]] constexpr U mix32(U v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

/// Random numbers are keyed by what they are for: hash(seed, purpose, pixel, ...).
template <typename... Keys>
[[nodiscard]] constexpr std::uint64_t hash(std::uint64_t first, Keys... rest) {
  std::uint64_t h = mix(first);
  ((h = mix(h ^ static_cast<std::uint64_t>(rest))), ...);
  return h;
}

}  // namespace vrc
