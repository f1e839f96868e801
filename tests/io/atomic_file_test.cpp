// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "support.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
  const test::TempDir folder;
  const fs::path target = test::write_file(folder / "out.txt", "old");
  {
    AtomicFile file(target);
    EXPECT_EQ(file.temporary().parent_path(), fs::canonical(folder.path()));
    EXPECT_EQ(file.temporary().extension(), ".txt");
    test::write_file(file.temporary(), "new");
    EXPECT_EQ(test::read_file(target), "old");
    file.commit();
    EXPECT_EQ(test::read_file(target), "new");
  }
  EXPECT_EQ(test::read_file(target), "new");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(AtomicFile, WithoutCommitLeavesTheOldFileAndNothingElse) {
  const test::TempDir folder;
  const fs::path target = test::write_file(folder / "out.txt", "old");
  {
    const AtomicFile file(target);
    test::write_file(file.temporary(), "half");
  }
  EXPECT_EQ(test::read_file(target), "old");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(AtomicFile, TwoWritersOfOneNameDoNotMeet) {
  const test::TempDir folder;
  AtomicFile first(folder / "out");
  AtomicFile second(folder / "out");
  EXPECT_NE(first.temporary(), second.temporary());
}

TEST(AtomicFile, KeepsALinkAndReplacesWhatItPointsTo) {
  const test::TempDir folder;
  const fs::path real = test::write_file(folder / "real.txt", "old");
  fs::create_symlink(real, folder / "link.txt");
  write_file_atomically(folder / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(test::read_file(real), "new");
}

TEST(AtomicFile, RefusesFoldersDevicesAndMissingFolders) {
  const test::TempDir folder;
  EXPECT_THROW(AtomicFile(folder.path()), InputError);
  EXPECT_THROW(AtomicFile(folder.path() / ""), InputError);
  EXPECT_THROW(AtomicFile("/dev/null"), InputError);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  try {
    require_writable(folder / "missing" / "out.txt");
    FAIL() << "a missing folder was accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("does not exist; create it first"));
  }
  EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(AtomicFile, WritesEveryByte) {
  const test::TempDir folder;
  const std::string bytes(3 << 20, '\0');
  write_file_atomically(folder / "zeros", bytes);
  EXPECT_EQ(test::read_file(folder / "zeros"), bytes);
  write_file_atomically(folder / "zeros", "");
  EXPECT_EQ(fs::file_size(folder / "zeros"), 0u);
}

TEST(AtomicFile, ProbeLeavesNothing) {
  const test::TempDir folder;
  require_writable(folder / "out.exr");
  EXPECT_EQ(files_in(folder.path()), 0u);
}

}  // namespace
}  // namespace vrc
