// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace vrc {

/// Exit codes of the program, for scripts.
enum ExitCode : int {
  kExitDone = 0,
  kExitFailure = 1,       ///< An error of the program itself; `compare` found values that are not finite;
                            ///< a claim of a `figure` does not hold.
  kExitBadInput = 2,      ///< A file or an argument cannot be used.
  kExitInterrupted = 130  ///< SIGINT or SIGTERM; what was written is marked as unfinished.
};

/// Parses the arguments of `main` and runs the command that they name. Results go to standard output;
/// progress, notes and errors to standard error. Never throws.
[[nodiscard]] int run_command_line(int argc, const char* const* argv);

}  // namespace vrc
