// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "support.h"

namespace vrc::test {
namespace fs = std::filesystem;
namespace {

constexpr auto kPollInterval = std::chrono::milliseconds(5);
constexpr int kMaxPolls = 12000;  // one minute

fs::path new_folder() {
  std::string pattern = (fs::temp_directory_path() / "vrc_program_XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  return pattern;
}

}  // namespace

Program::Program(const std::vector<std::string>& arguments) : folder_(new_folder()) {
  const std::string program = VRC_BINARY_DIR "/vrc";
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const std::string out = folder_ / "out", err = folder_ / "err";
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  // Whoever runs the tests may ignore these signals; the program under test shall not.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGINT);
  sigaddset(&defaults, SIGTERM);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  const int error = ::posix_spawn(&pid_, program.c_str(), &files, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    fs::remove_all(folder_);
    throw std::runtime_error("cannot run " + program);
  }
}

Program::~Program() {
  if (!reaped_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, &status_, 0);
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

bool Program::ended() {
  if (!reaped_) reaped_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
  return reaped_;
}

bool Program::wait_for_error_text(const std::string& text) {
  for (int i = 0; i < kMaxPolls; ++i) {
    if (read_file(folder_ / "err").find(text) != std::string::npos) return true;
    if (ended()) return false;
    std::this_thread::sleep_for(kPollInterval);
  }
  return false;
}

ProgramResult Program::finish() {
  if (!reaped_) {
    ::waitpid(pid_, &status_, 0);
    reaped_ = true;
  }
  const int code = WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  return {code, read_file(folder_ / "out"), read_file(folder_ / "err")};
}

ProgramResult run_vrc(const std::vector<std::string>& arguments) { return Program(arguments).finish(); }

fs::path write_test_scene(const fs::path& folder) {
  return write_file(folder / "scene.xml", R"(<scene version="3.0.0">
  <default name="floor" value="0.6"/>
  <integrator type="path"><integer name="max_depth" value="3"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="45"/>
    <transform name="to_world"><lookat origin="0, 1, 4" target="0, 0.5, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm">
      <integer name="width" value="32"/><integer name="height" value="24"/><rfilter type="box"/>
    </film>
    <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
  </sensor>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="$floor, $floor, $floor"/></bsdf>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><scale value="3"/><translate z="-1.5"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.3, 0.2"/></bsdf>
  </shape>
  <shape type="cube">
    <transform name="to_world"><scale value="0.4"/><translate y="0.4"/></transform>
    <bsdf type="phong">
      <float name="exponent" value="40"/>
      <rgb name="diffuse_reflectance" value="0.2, 0.2, 0.2"/>
      <rgb name="specular_reflectance" value="0.5, 0.5, 0.5"/>
    </bsdf>
  </shape>
  <emitter type="point"><point name="position" x="1" y="2.5" z="1"/><rgb name="intensity" value="8"/></emitter>
</scene>
)");
}

}  // namespace vrc::test
