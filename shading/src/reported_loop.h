// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <mutex>
#include <string_view>

#include "core/parallel.h"
#include "core/run_control.h"

namespace vrc {

/// Calls body(i) for i in [0, count) from several threads, none any more once it is to stop, and reports how
/// far the phase has come.
template <typename Body>
void for_each_reported(std::size_t count, std::string_view phase, const RunControl& control,
                       const Body& body) {
  std::atomic<std::size_t> done{0};
  std::mutex reporting;
  control.report({phase, 0.0, 0, 0});
  parallel_for(count, [&](std::size_t i) {
    if (!control.stopped()) body(i);
    done.fetch_add(1);
    if (const std::unique_lock lock(reporting, std::try_to_lock); lock)
      control.report({phase, static_cast<double>(done.load()) / static_cast<double>(count), 0, 0});
  });
}

}  // namespace vrc
