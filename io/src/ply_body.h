// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ply_header.h"
#include "text_file.h"

namespace vrc {

// The two kinds of PLY body offer the same operations, in the order of the header: for each row of
// an element `begin_row`, its properties, `end_row`; after the last element `finish`. Every value is
// returned as a double, which holds all types of PLY exactly. They throw InputError where the data
// ends early, are malformed, or go on after the last element.

/// One row per line, as words.
class AsciiPlyBody {
 public:
  AsciiPlyBody(const std::string& file, const PlyHeader& header)
      : scanner_(file, header.body, TextSyntax::kPlain, header.body_line) {}

  void begin_row(const PlyElement& element, std::uint64_t row);
  double scalar(PlyType type);
  /// The length of a list; at least 0.
  std::uint64_t list_length(const PlyProperty& list);
  /// Passes over values that are not wanted; they may be anything.
  void skip(PlyType type, std::uint64_t count);
  void end_row();
  void finish();
  [[noreturn]] void fail(const std::string& problem) const { scanner_.fail(problem); }

 private:
  [[noreturn]] void fail_short_row() const;

  TextScanner scanner_;
};

/// Packed values of either byte order.
class BinaryPlyBody {
 public:
  BinaryPlyBody(const std::string& file, const PlyHeader& header);

  void begin_row(const PlyElement& element, std::uint64_t row) {
    element_ = &element;
    row_ = row;
  }
  double scalar(PlyType type);
  /// The length of a list; its entries are known to be in the file.
  std::uint64_t list_length(const PlyProperty& list);
  void skip(PlyType type, std::uint64_t count);
  void end_row() {}
  void finish();
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  template <typename Value>
  Value load();
  void require_bytes(std::uint64_t count, std::size_t size) const;

  std::string file_;
  const char* cursor_;
  const char* end_;
  bool swap_bytes_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

}  // namespace vrc
