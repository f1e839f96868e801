// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vrc {

/// The whole content of a regular file, byte for byte. Throws InputError when the file is missing,
/// is a folder, cannot be read, or is empty.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// `text` without the mark that some editors put before UTF-8.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

/// `token` between quotes for a message: cut when long, control characters spelled out.
[[nodiscard]] std::string in_quotes(std::string_view token);

/// The words of `text`, which blanks (spaces, tabs, carriage returns) separate.
[[nodiscard]] std::vector<std::string_view> split_words(std::string_view text);

/// `token` as a decimal integer of 64 bits; nothing when it is anything else.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view token);

enum class TextSyntax {
  kPlain,      ///< Lines and words only (PLY).
  kWavefront,  ///< `#` at the start of a word begins a comment, `\` at a line's end continues it.
};

/// Walks over a text line by line and word by word, and knows the line for messages. Words are
/// separated by blanks; LF and CRLF end a line. Holds a view of the text, not a copy.
class TextScanner {
 public:
  TextScanner(std::string file, std::string_view text, TextSyntax syntax, std::size_t first_line = 1);

  /// Leaves the current line and goes to the next one that has a word; false at the end of the text.
  bool next_line();
  /// The next word of this line; empty when there is none left.
  std::string_view word();
  /// What is left of this line without outer blanks and comment: a name that may contain blanks.
  std::string rest_of_line();

  /// The next word as a number; nothing at the line's end. Throws InputError when the word is not a
  /// decimal number or is not finite. Magnitudes below the double range become 0.
  std::optional<double> number();

  /// Everything behind the current line.
  [[nodiscard]] std::string_view text_after_line() const;
  /// The line (from 1) of the last word read.
  [[nodiscard]] std::size_t line() const { return line_; }
  /// Throws InputError at the current line.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  void skip_blanks();
  [[nodiscard]] bool at_line_end() const { return cursor_ == end_ || *cursor_ == '\n'; }
  [[nodiscard]] const char* continuation_end(const char* at) const;

  std::string file_;
  const char* cursor_;
  const char* end_;
  TextSyntax syntax_;
  std::size_t line_;
  bool started_ = false;
};

}  // namespace vrc
