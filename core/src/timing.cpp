// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/timing.h"

#include <sys/resource.h>

#include <chrono>
#include <ctime>

namespace vrc {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

double process_cpu_seconds() { return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID); }
double thread_cpu_seconds() { return cpu_seconds(CLOCK_THREAD_CPUTIME_ID); }

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

PhaseTimer::PhaseTimer(std::string name)
    : name_(std::move(name)), wall_start_(wall_seconds()), cpu_start_(process_cpu_seconds()) {}

PhaseTime PhaseTimer::elapsed() const {
  return {name_, wall_seconds() - wall_start_, process_cpu_seconds() - cpu_start_};
}

}  // namespace vrc
