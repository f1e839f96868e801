// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vrc {

/// Reads a record map of comma-separated values record by record; cells are found by the names in the first
/// line.
class RecordTable {
 public:
  /// Throws InputError when the file cannot be read or has not the `required` columns.
  RecordTable(const std::filesystem::path& path, std::span<const std::string_view> required);

  /// Goes to the next record; false after the last. Throws InputError when it has not a value for each
  /// column.
  [[nodiscard]] bool next();
  [[nodiscard]] bool has(std::string_view name) const { return columns_.contains(name); }
  /// Of a column that there is.
  [[nodiscard]] std::string_view word(std::string_view name) const;
  /// 0 for numbers beyond those of the type. Throws InputError when there is no number.
  template <typename T>
  [[nodiscard]] T number(std::string_view name) const {
    const std::string_view cell = word(name);
    T value{};
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error == std::errc::result_out_of_range) return T{};
    if (error != std::errc() || end != cell.data() + cell.size())
      fail(fmt::format("'{}' of column '{}' is no number; write the file again", cell, name));
    return value;
  }

 private:
  [[nodiscard]] bool read_line();
  [[noreturn]] void fail(const std::string& problem) const;

  std::filesystem::path path_;
  std::ifstream in_;
  std::string line_;
  std::size_t line_number_ = 0;
  std::map<std::string, std::size_t, std::less<>> columns_;
  std::vector<std::string_view> cells_;
};

}  // namespace vrc
