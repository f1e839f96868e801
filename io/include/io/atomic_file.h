// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace vrc {

/// An output file that appears under its name only when it is whole: it is written under a temporary
/// name in the same folder and renamed by `commit`. Without `commit` the temporary is removed and a
/// file that was there before is left as it was.
class AtomicFile {
 public:
  /// Makes the empty temporary file. Throws InputError when the folder is missing or not writable,
  /// or when `path` names a folder, a device or anything else that is not a regular file.
  explicit AtomicFile(const std::filesystem::path& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Where to write; it has the extension of the final name.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// Flushes the content to the disk and gives the file its name. Throws InputError when that fails.
  void commit();

 private:
  std::filesystem::path target_;  ///< With links resolved, so that a link is kept.
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// Writes all `bytes`. Throws InputError.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Throws InputError when a file of this name could not be written; leaves nothing behind.
void require_writable(const std::filesystem::path& path);

}  // namespace vrc
