// SPDX-License-Identifier: GPL-3.0-or-later
#include "text_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <fstream>

#include "core/error.h"

namespace vrc {
namespace {

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// The position of the '#' that begins a comment: at the start, or after a blank. A '#' inside a
// word belongs to a name.
std::size_t comment_start(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '#' && (i == 0 || is_blank(text[i - 1]))) return i;
  }
  return std::string_view::npos;
}

// Whether a word that does not fit a double is merely too small for it.
bool underflows(const char* begin, const char* end) {
  long double value = 1.0L;
  return std::from_chars(begin, end, value).ec == std::errc() && std::abs(value) < 1.0L;
}

}  // namespace

std::string read_whole_file(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    throw InputError(path.string(), 0, "the file does not exist; check the path");
  }
  if (fs::is_directory(status)) throw InputError(path.string(), 0, "this is a folder; name a file in it");
  if (!fs::is_regular_file(status)) {
    throw InputError(path.string(), 0, "this is not a readable file; check the path and its permissions");
  }
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) {
    throw InputError(path.string(), 0, "the file cannot be opened; check its permissions");
  }
  if (size == 0) throw InputError(path.string(), 0, "the file is empty; export it again");
  std::string content;
  try {
    content.resize(size);
  } catch (const std::exception&) {  // bad_alloc or length_error
    throw InputError(path.string(), 0, fmt::format("its {} bytes do not fit into memory", size));
  }
  if (!in.read(content.data(), static_cast<std::streamsize>(size))) {
    throw InputError(path.string(), 0, "the file cannot be read to its end; check the disk");
  }
  return content;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

std::string in_quotes(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  std::string text = "'";
  for (const char c : token.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7F) {
      text += fmt::format("\\x{:02x}", byte);
    } else {
      text += c;
    }
  }
  return text + (token.size() > kLongest ? "...'" : "'");
}

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const auto end = std::find_if(text.begin(), text.end(), is_blank);
    words.push_back(text.substr(0, static_cast<std::size_t>(end - text.begin())));
    text.remove_prefix(words.back().size());
  }
  return words;
}

std::optional<std::int64_t> parse_integer(std::string_view token) {
  if (token.size() > 1 && token.front() == '+' && token[1] != '-') token.remove_prefix(1);
  std::int64_t value = 0;
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

TextScanner::TextScanner(std::string file, std::string_view text, TextSyntax syntax, std::size_t first_line)
    : file_(std::move(file)),
      cursor_(text.data()),
      end_(text.data() + text.size()),
      syntax_(syntax),
      line_(first_line) {}

bool TextScanner::next_line() {
  while (true) {
    if (started_) {
      while (!word().empty()) {
      }
      if (cursor_ == end_) return false;
      ++cursor_;
      ++line_;
    }
    started_ = true;
    skip_blanks();
    if (!at_line_end()) return true;
  }
}

std::string_view TextScanner::word() {
  skip_blanks();
  const char* begin = cursor_;
  while (!at_line_end() && !is_blank(*cursor_)) {
    if (*cursor_ == '\\' && continuation_end(cursor_) != nullptr) break;
    ++cursor_;
  }
  return {begin, static_cast<std::size_t>(cursor_ - begin)};
}

std::string TextScanner::rest_of_line() {
  std::string rest;
  while (true) {
    const char* begin = cursor_;
    cursor_ = std::find(cursor_, end_, '\n');
    const std::string_view part = trimmed({begin, static_cast<std::size_t>(cursor_ - begin)});
    if (syntax_ == TextSyntax::kPlain) return rest.append(part);
    if (const std::size_t comment = comment_start(part); comment != std::string_view::npos) {
      rest.append(trimmed(part.substr(0, comment)));
      break;
    }
    if (part.empty() || part.back() != '\\' || cursor_ == end_) {
      rest.append(part);
      break;
    }
    rest.append(part.substr(0, part.size() - 1)).append(" ");
    ++cursor_;
    ++line_;
  }
  return std::string(trimmed(rest));
}

std::optional<double> TextScanner::number() {
  skip_blanks();
  if (at_line_end()) return std::nullopt;
  const char* begin = cursor_;
  if (*begin == '+' && begin + 1 != end_ && begin[1] != '-') ++begin;  // from_chars takes no plus sign.
  double value = 0.0;
  const auto [stop, error] = std::from_chars(begin, end_, value);
  const bool whole_word = stop == end_ || *stop == '\n' || is_blank(*stop) ||
                          (*stop == '\\' && continuation_end(stop) != nullptr);
  if (whole_word && error == std::errc() && std::isfinite(value)) {
    cursor_ = stop;
    return value;
  }
  if (whole_word && error == std::errc::result_out_of_range && underflows(begin, stop)) {
    cursor_ = stop;
    return 0.0;
  }
  const std::string shown = in_quotes(word());
  if (!whole_word || error == std::errc::invalid_argument) {
    fail(shown + " is not a number; write a decimal number such as 1.5e-3");
  }
  fail(shown + " is not a finite number; repair the data or export the file again");
}

std::string_view TextScanner::text_after_line() const {
  const char* line_end = std::find(cursor_, end_, '\n');
  if (line_end != end_) ++line_end;
  return {line_end, static_cast<std::size_t>(end_ - line_end)};
}

void TextScanner::fail(const std::string& problem) const { throw InputError(file_, line_, problem); }

void TextScanner::skip_blanks() {
  while (cursor_ != end_) {
    if (is_blank(*cursor_)) {
      ++cursor_;
    } else if (*cursor_ == '\\' && continuation_end(cursor_) != nullptr) {
      cursor_ = continuation_end(cursor_);
      ++line_;
    } else {
      break;
    }
  }
  if (syntax_ == TextSyntax::kWavefront && cursor_ != end_ && *cursor_ == '#') {
    cursor_ = std::find(cursor_, end_, '\n');
  }
}

// Past the line break, when `at` is a backslash that ends its line; else null.
const char* TextScanner::continuation_end(const char* at) const {
  if (syntax_ == TextSyntax::kPlain) return nullptr;
  do {
    ++at;
  } while (at != end_ && *at == '\r');
  return at != end_ && *at == '\n' ? at + 1 : nullptr;
}

}  // namespace vrc
