// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace vrc {

/// Limits the worker threads of the process; 0 uses every processor. Returns the number in use.
int set_thread_count(int threads);
[[nodiscard]] int thread_count();

/// Calls body(i) for i in [0, count) from several threads; each thread flushes denormals to zero.
/// The caller writes results to slots of their own, so that they do not depend on the threads.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace vrc
