// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string_view>

namespace vrc {

/// What a long computation tells its caller while it works.
struct ProgressUpdate {
  std::string_view phase;     ///< "place records", "render", ...
  double fraction = 0.0;      ///< Of this phase, in [0, 1].
  std::uint64_t records = 0;  ///< Records made so far; 0 outside record placement.
  std::uint64_t rays = 0;     ///< Rays traced so far in this phase.
};

/// Passed down into long computations. Calls to `progress` are serialised by the computation.
struct RunControl {
  std::function<void(const ProgressUpdate&)> progress;
  const std::atomic<bool>* stop = nullptr;  ///< Becomes true when the user interrupts.

  [[nodiscard]] bool stopped() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
  void report(const ProgressUpdate& update) const {
    if (progress) progress(update);
  }
};

}  // namespace vrc
