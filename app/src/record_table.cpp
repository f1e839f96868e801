// SPDX-License-Identifier: GPL-3.0-or-later
#include "record_table.h"

#include "cli_values.h"
#include "core/error.h"

namespace vrc {

RecordTable::RecordTable(const std::filesystem::path& path, std::span<const std::string_view> required)
    : path_(path), in_(path, std::ios::binary) {
  if (!in_ || !read_line()) fail("cannot be read; give a record map of vrc in .csv");
  const std::vector<std::string_view> names = split(line_, ',');
  for (std::size_t i = 0; i < names.size(); ++i) columns_.emplace(names[i], i);
  for (const std::string_view name : required) {
    if (!has(name))
      fail(fmt::format("has no column '{}'; write it with --record-map of this version of vrc", name));
  }
}

bool RecordTable::read_line() {
  if (!std::getline(in_, line_)) return false;
  ++line_number_;
  if (!line_.empty() && line_.back() == '\r') line_.pop_back();
  return true;
}

bool RecordTable::next() {
  do {
    if (!read_line()) return false;
  } while (line_.empty());
  cells_ = split(line_, ',');
  if (cells_.size() != columns_.size())
    fail(fmt::format("has {} values for {} columns; write the file again", cells_.size(), columns_.size()));
  return true;
}

std::string_view RecordTable::word(std::string_view name) const {
  return cells_[columns_.find(name)->second];
}

void RecordTable::fail(const std::string& problem) const {
  throw InputError(path_.string(), line_number_, problem);
}

}  // namespace vrc
