// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace vrc {

/// Wall-clock and process CPU seconds spent in a named phase.
struct PhaseTime {
  std::string name;
  double seconds = 0.0;
  double cpu_seconds = 0.0;  ///< All threads of this process.
};

/// Measures from construction.
class PhaseTimer {
 public:
  explicit PhaseTimer(std::string name);
  [[nodiscard]] PhaseTime elapsed() const;

 private:
  std::string name_;
  double wall_start_;
  double cpu_start_;
};

/// CPU seconds of all threads of this process since it began.
[[nodiscard]] double process_cpu_seconds();
/// CPU seconds of the calling thread since it began.
[[nodiscard]] double thread_cpu_seconds();
/// Largest resident set of this process so far, in bytes.
[[nodiscard]] std::size_t peak_memory_bytes();

}  // namespace vrc
