// SPDX-License-Identifier: GPL-3.0-or-later
#include "ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/error.h"
#include "text_file.h"

namespace vrc {
namespace {

// Both naming styles that are in use.
constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypeNames{{{"char", PlyType::kInt8},
                                                                           {"int8", PlyType::kInt8},
                                                                           {"uchar", PlyType::kUint8},
                                                                           {"uint8", PlyType::kUint8},
                                                                           {"short", PlyType::kInt16},
                                                                           {"int16", PlyType::kInt16},
                                                                           {"ushort", PlyType::kUint16},
                                                                           {"uint16", PlyType::kUint16},
                                                                           {"int", PlyType::kInt32},
                                                                           {"int32", PlyType::kInt32},
                                                                           {"uint", PlyType::kUint32},
                                                                           {"uint32", PlyType::kUint32},
                                                                           {"float", PlyType::kFloat32},
                                                                           {"float32", PlyType::kFloat32},
                                                                           {"double", PlyType::kFloat64},
                                                                           {"float64", PlyType::kFloat64}}};

class HeaderParser {
 public:
  HeaderParser(const std::string& file, std::string_view text) : scanner_(file, text, TextSyntax::kPlain) {}

  PlyHeader parse() && {
    if (!scanner_.next_line() || scanner_.rest_of_line() != "ply") {
      scanner_.fail("the first line is not 'ply'; check that this is a PLY file");
    }
    while (true) {
      if (!scanner_.next_line()) {
        scanner_.fail("the header has no 'end_header'; the file is truncated, so export it again");
      }
      const std::string_view keyword = scanner_.word();
      if (keyword == "end_header") break;
      statement(keyword);
    }
    expect_line_end();
    if (!format_) scanner_.fail("the header has no 'format'; add 'format ascii 1.0' or the binary form");
    header_.format = *format_;
    header_.body = scanner_.text_after_line();
    header_.body_line = scanner_.line() + 1;
    return std::move(header_);
  }

 private:
  void statement(std::string_view keyword);
  void format();
  void element();
  void property();
  PlyType type();
  std::string name(const char* what);
  void expect_line_end();

  TextScanner scanner_;
  PlyHeader header_;
  std::optional<PlyFormat> format_;
};

void HeaderParser::statement(std::string_view keyword) {
  if (keyword == "comment" || keyword == "obj_info") return;
  if (keyword == "format") {
    format();
  } else if (keyword == "element") {
    element();
  } else if (keyword == "property") {
    property();
  } else {
    scanner_.fail(in_quotes(keyword) + " is not a statement of a PLY header; remove the line");
  }
  expect_line_end();
}

void HeaderParser::format() {
  const std::string_view word = scanner_.word();
  if (word == "ascii") {
    format_ = PlyFormat::kAscii;
  } else if (word == "binary_little_endian") {
    format_ = PlyFormat::kBinaryLittleEndian;
  } else if (word == "binary_big_endian") {
    format_ = PlyFormat::kBinaryBigEndian;
  } else {
    scanner_.fail(in_quotes(word) + " is not a format; use ascii, binary_little_endian or binary_big_endian");
  }
  if (const std::string_view version = scanner_.word(); version != "1.0") {
    scanner_.fail(in_quotes(version) + " is not a known version of PLY; 1.0 is the only one");
  }
}

void HeaderParser::element() {
  PlyElement element;
  element.line = scanner_.line();
  element.name = name("element");
  const std::string_view word = scanner_.word();
  const std::optional<std::int64_t> count = parse_integer(word);
  if (!count || *count < 0) {
    scanner_.fail(fmt::format("{} is not a number of '{}' elements; write 'element NAME COUNT'",
                              in_quotes(word), element.name));
  }
  element.count = static_cast<std::uint64_t>(*count);
  for (const PlyElement& other : header_.elements) {
    if (other.name == element.name) {
      scanner_.fail(fmt::format("element '{}' appears twice; remove one", element.name));
    }
  }
  header_.elements.push_back(std::move(element));
}

void HeaderParser::property() {
  if (header_.elements.empty()) scanner_.fail("'property' before any 'element'; correct the order");
  PlyProperty property;
  TextScanner ahead = scanner_;
  if (ahead.word() == "list") {
    scanner_.word();
    property.count_type = type();
    if (!is_integer(*property.count_type)) {
      scanner_.fail("the length of a list has a floating-point type; use an integer type such as uchar");
    }
  }
  property.type = type();
  property.name = name("property");
  auto& properties = header_.elements.back().properties;
  for (const PlyProperty& other : properties) {
    if (other.name == property.name) {
      scanner_.fail(fmt::format("property '{}' appears twice in element '{}'; remove one", property.name,
                                header_.elements.back().name));
    }
  }
  properties.push_back(std::move(property));
}

PlyType HeaderParser::type() {
  const std::string_view word = scanner_.word();
  for (const auto& [type_name, type] : kTypeNames) {
    if (type_name == word) return type;
  }
  scanner_.fail(in_quotes(word) +
                " is not a type of PLY; use char, uchar, short, ushort, int, uint, float or double");
}

std::string HeaderParser::name(const char* what) {
  const std::string_view word = scanner_.word();
  if (word.empty()) scanner_.fail(fmt::format("the name of the {} is missing; add it", what));
  return std::string(word);
}

void HeaderParser::expect_line_end() {
  if (const std::string_view extra = scanner_.word(); !extra.empty()) {
    scanner_.fail(in_quotes(extra) + " is one word too many in this header line; remove it");
  }
}

std::uint64_t count_filled_lines(std::string_view text) {
  std::uint64_t lines = 0;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.find_first_not_of(" \t\r\v\f") != std::string_view::npos) ++lines;
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return lines;
}

// One line for each row of an ascii body; the least number of bytes of a row of a binary one, when
// all its lists are empty.
std::uint64_t least_row_size(const PlyElement& element, PlyFormat format) {
  if (element.properties.empty()) return 0;
  if (format == PlyFormat::kAscii) return 1;
  std::uint64_t size = 0;
  for (const PlyProperty& property : element.properties) {
    size += size_of(property.count_type.value_or(property.type));
  }
  return size;
}

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool is_integer(PlyType type) { return type != PlyType::kFloat32 && type != PlyType::kFloat64; }

PlyHeader parse_ply_header(const std::string& file, std::string_view text) {
  return HeaderParser(file, text).parse();
}

void check_counts(const std::string& file, const PlyHeader& header) {
  const bool ascii = header.format == PlyFormat::kAscii;
  std::uint64_t left = ascii ? count_filled_lines(header.body) : header.body.size();
  for (const PlyElement& element : header.elements) {
    const std::uint64_t row = least_row_size(element, header.format);
    if (row == 0) continue;
    if (element.count > left / row) {
      throw InputError(file, element.line,
                       fmt::format("the header promises {} of element '{}', but the file ends after {}{}; it "
                                   "is truncated or the count is wrong, so export it again",
                                   element.count, element.name, ascii ? "" : "at most ", left / row));
    }
    left -= element.count * row;
  }
}

}  // namespace vrc
