// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace vrc::test {

struct ProgramResult {
  int exit_code = -1;  ///< -N when signal N ended the program.
  std::string out;
  std::string err;
};

/// A running `vrc` whose two output streams go to files.
class Program {
 public:
  explicit Program(const std::vector<std::string>& arguments);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  /// Waits until the error stream holds `text`; false when the program ends, or a minute passes, without.
  [[nodiscard]] bool wait_for_error_text(const std::string& text);
  void send(int signal) const { ::kill(pid_, signal); }
  [[nodiscard]] ProgramResult finish();

 private:
  [[nodiscard]] bool ended();

  std::filesystem::path folder_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool reaped_ = false;
};

/// Runs `vrc` with these arguments to its end.
[[nodiscard]] ProgramResult run_vrc(const std::vector<std::string>& arguments);

/// A box of light grey planes with a point light and a small glossy block, as a scene file for tests.
[[nodiscard]] std::filesystem::path write_test_scene(const std::filesystem::path& folder);

}  // namespace vrc::test
