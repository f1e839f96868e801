// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace vrc {

/// The user's input cannot be used: a file, a scene element or a command-line value.
/// `what()` reads "FILE:LINE: problem; remedy" and is printed as it is; the program exits with 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// `line` 0 means that the problem has no line (a binary file, a missing file).
  InputError(const std::string& file, std::size_t line, const std::string& problem)
      : std::runtime_error(line == 0 ? fmt::format("{}: {}", file, problem)
                                     : fmt::format("{}:{}: {}", file, line, problem)) {}
};

/// The user asked the program to stop (SIGINT or SIGTERM); the program exits with 130.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace vrc

/// Aborts with the condition and a message when an invariant of the program itself is broken.
#define VRC_CHECK(condition, ...)                                                                       \
  do {                                                                                                  \
    if (!(condition)) {                                                                                 \
      throw std::logic_error(fmt::format("{}:{}: check failed: {}: {}", __FILE__, __LINE__, #condition, \
                                         fmt::format(__VA_ARGS__)));                                    \
    }                                                                                                   \
  } while (false)
