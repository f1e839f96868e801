// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

std::string reason() { return std::strerror(errno); }

/// An open file descriptor, closed at scope end.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool valid() const { return fd_ >= 0; }

 private:
  int fd_;
};

fs::path resolve(const fs::path& path) {
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(path, error);
  return error ? path : resolved;
}

void require_replaceable(const fs::path& shown, const fs::path& target) {
  std::error_code error;
  if (shown.filename().empty()) {
    throw InputError(shown.string(), 0, "names no file; give the name of the file to write");
  }
  const fs::path folder = target.parent_path();
  if (!folder.empty() && !fs::is_directory(folder, error)) {
    throw InputError(shown.string(), 0,
                     fmt::format("the folder {} does not exist; create it first", folder.string()));
  }
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status))
    throw InputError(shown.string(), 0, "is a folder; give the name of a file in it");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw InputError(shown.string(), 0, "is not a regular file; give another name");
  }
}

/// Creates a file of a name that no other process or earlier run has taken.
fs::path create_temporary(const fs::path& shown, const fs::path& target) {
  for (int attempt = 0;; ++attempt) {
    fs::path candidate = target.parent_path() / fmt::format(".{}.{}-{}.part{}", target.stem().string(),
                                                            ::getpid(), attempt, target.extension().string());
    const Descriptor file(::open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.valid()) return candidate;
    if (errno != EEXIST) throw InputError(shown.string(), 0, "cannot be written: " + reason());
  }
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path) : target_(resolve(path)) {
  require_replaceable(path, target_);
  temporary_ = create_temporary(path, target_);
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  {
    const Descriptor file(::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.valid() || ::fsync(file.get()) != 0) {
      throw InputError(target_.string(), 0, "cannot be written: " + reason());
    }
  }
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) throw InputError(target_.string(), 0, "cannot be written: " + error.message());
  committed_ = true;
}

void write_file_atomically(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  {
    const Descriptor out(::open(file.temporary().c_str(), O_WRONLY | O_CLOEXEC));
    while (out.valid() && !bytes.empty()) {
      const ssize_t written = ::write(out.get(), bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) break;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    if (!out.valid() || !bytes.empty()) throw InputError(path.string(), 0, "cannot be written: " + reason());
  }
  file.commit();
}

void require_writable(const fs::path& path) { const AtomicFile probe(path); }

}  // namespace vrc
