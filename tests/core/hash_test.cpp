// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/hash.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

namespace vrc {
namespace {

TEST(Hash, MixIsSplitMix64) {
  // The first outputs of the published generator for the seeds 0 and 1234567.
  static_assert(mix(0) == 0xe220a8397b1dcdafull);
  EXPECT_EQ(mix(1234567), 6457827717110365317ull);
}

TEST(Hash, SmallKeysDoNotCollide) {
  std::set<std::uint64_t> seen;
  for (int a = 0; a < 32; ++a) {
    for (int b = -16; b < 16; ++b) {
      for (int c = 0; c < 32; ++c) seen.insert(hash(static_cast<std::uint64_t>(a), b, c));
      seen.insert(hash(static_cast<std::uint64_t>(a), b));
    }
    seen.insert(hash(static_cast<std::uint64_t>(a)));
  }
  EXPECT_EQ(seen.size(), 32u * 32 * 32 + 32 * 32 + 32);
}

TEST(Hash, OrderAndCountOfKeysMatter) {
  EXPECT_NE(hash(1, 2), hash(2, 1));
  EXPECT_NE(hash(1, 2, 3), hash(1, 3, 2));
  EXPECT_NE(hash(1), hash(1, 0));
}

TEST(Hash, OneBitOfAKeyTurnsHalfOfTheResult) {
  int turned = 0, pairs = 0;
  for (std::uint64_t key = 0; key < 256; ++key) {
    for (int bit = 0; bit < 64; ++bit, ++pairs) {
      turned += std::popcount(hash(7, key, 3) ^ hash(7, key ^ (1ull << bit), 3));
    }
  }
  EXPECT_NEAR(static_cast<double>(turned) / pairs, 32.0, 0.2);  // standard deviation of the mean: 0.03
}

}  // namespace
}  // namespace vrc
