// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>

#include "core/hash.h"
#include "core/simd.h"

namespace vrc {

/// In [0, 1), by hashing two coordinates of a sample.
[[nodiscard]] inline F16 random_of(F16 u1, F16 u2) {
  return to_unit_interval(mix32(std::bit_cast<U16>(bits(u1)) * 0x9e3779b9u + std::bit_cast<U16>(bits(u2))));
}

/// In each lane one of the things that are offered, with probabilities in proportion to their weights, which
/// need not be known before [Talbot2005].
class WeightedChoice16 {
 public:
  /// `random`: uniform in [0, 1).
  explicit WeightedChoice16(F16 random) : left_(random) {}

  /// Lanes that take what has this weight instead of what they had.
  I16 offer(F16 weight) {
    total_ += weight;
    const F16 share = weight / max(total_, 1e-30f);
    const I16 taken = left_ < share;
    left_ = select(taken, left_ / max(share, 1e-20f), (left_ - share) / max(1.0f - share, 1e-20f));
    chosen_ = select(taken, weight, chosen_);
    return taken;
  }

  /// Of all weights.
  [[nodiscard]] F16 total() const { return total_; }
  /// The weight of what is chosen; 0: nothing.
  [[nodiscard]] F16 chosen() const { return chosen_; }

 private:
  F16 left_;  // of the random number, uniform again whatever was taken
  F16 total_{}, chosen_{};
};

}  // namespace vrc
