// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mtl_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "text_file.h"

namespace vrc {
namespace {

// Options of map_* statements and how many words follow each [Wavefront MTL 4.0]; those of
// `kVectorOptions` are followed by one to three numbers.
constexpr std::array<std::pair<std::string_view, std::size_t>, 10> kOptions{{{"-blendu", 1},
                                                                             {"-blendv", 1},
                                                                             {"-cc", 1},
                                                                             {"-clamp", 1},
                                                                             {"-boost", 1},
                                                                             {"-mm", 2},
                                                                             {"-texres", 1},
                                                                             {"-imfchan", 1},
                                                                             {"-bm", 1},
                                                                             {"-type", 1}}};
constexpr std::array<std::string_view, 3> kVectorOptions{"-o", "-s", "-t"};

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("+-.0123456789eE") == std::string_view::npos;
}

// How many of `words`, the first of which begins with '-', are one option and its values.
std::size_t option_length(const std::vector<std::string_view>& words, std::size_t at) {
  for (const auto& [name, values] : kOptions) {
    if (words[at] == name) return 1 + values;
  }
  if (std::find(kVectorOptions.begin(), kVectorOptions.end(), words[at]) == kVectorOptions.end()) return 0;
  std::size_t length = 1;
  while (length <= 3 && at + length < words.size() && is_number(words[at + length])) ++length;
  return length;
}

// The file name of a map statement, which may contain blanks, without the options before it.
std::string texture_name(const std::string& arguments) {
  const std::vector<std::string_view> words = split_words(arguments);
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t length = words[at].front() == '-' ? option_length(words, at) : 0;
    if (length == 0) break;
    at += length;
  }
  if (at >= words.size()) return {};
  return arguments.substr(static_cast<std::size_t>(words[at].data() - arguments.data()));
}

class MtlParser {
 public:
  MtlParser(const std::filesystem::path& path, std::string_view text)
      : scanner_(path.string(), text, TextSyntax::kWavefront) {}

  std::vector<MtlMaterial> parse() && {
    while (scanner_.next_line()) statement(std::string(scanner_.word()));
    return std::move(materials_);
  }

 private:
  void statement(const std::string& keyword);
  MtlMaterial& current(const std::string& keyword);
  Rgb color(const std::string& keyword);
  float scalar(const std::string& keyword, float highest);
  float checked(const std::string& keyword, double value, float highest);

  TextScanner scanner_;
  std::vector<MtlMaterial> materials_;
};

void MtlParser::statement(const std::string& keyword) {
  constexpr float kUnbounded = std::numeric_limits<float>::max();
  if (keyword == "newmtl") {
    MtlMaterial material;
    material.name = scanner_.rest_of_line();
    if (material.name.empty()) scanner_.fail("'newmtl' without a name; name the material");
    materials_.push_back(std::move(material));
  } else if (keyword == "Kd") {
    current(keyword).diffuse = color(keyword);
  } else if (keyword == "Ks") {
    current(keyword).specular = color(keyword);
  } else if (keyword == "Ke") {
    current(keyword).emission = color(keyword);
  } else if (keyword == "Ns") {
    current(keyword).shininess = scalar(keyword, kUnbounded);
  } else if (keyword == "Pr") {
    current(keyword).roughness = scalar(keyword, 1.0f);
  } else if (keyword == "Pm") {
    current(keyword).metallic = scalar(keyword, 1.0f);
  } else if (keyword.starts_with("map_")) {
    std::string name = texture_name(scanner_.rest_of_line());
    if (name.empty())
      scanner_.fail(in_quotes(keyword) + " without a file name; name the image or remove the line");
    current(keyword).textures.push_back(std::move(name));
  }
}

MtlMaterial& MtlParser::current(const std::string& keyword) {
  if (materials_.empty()) {
    scanner_.fail(in_quotes(keyword) + " before the first 'newmtl'; begin the material with 'newmtl NAME'");
  }
  return materials_.back();
}

// r g b, or r alone for a grey.
Rgb MtlParser::color(const std::string& keyword) {
  TextScanner ahead = scanner_;
  const std::string form(ahead.word());
  if (form == "spectral" || form == "xyz") {
    scanner_.fail(fmt::format("'{0} {1}' is not supported; write '{0} r g b' in linear RGB", keyword, form));
  }
  Rgb rgb = Rgb::Zero();
  int n = 0;
  while (const std::optional<double> value = scanner_.number()) {
    if (n == 3) scanner_.fail(fmt::format("'{0}' with more than 3 numbers; write '{0} r g b'", keyword));
    rgb[n++] = checked(keyword, *value, std::numeric_limits<float>::max());
  }
  if (n == 1) return Rgb::Constant(rgb[0]);
  if (n != 3) scanner_.fail(fmt::format("'{0}' with {1} numbers; write '{0} r g b'", keyword, n));
  return rgb;
}

float MtlParser::scalar(const std::string& keyword, float highest) {
  const std::optional<double> value = scanner_.number();
  if (!value) scanner_.fail(fmt::format("'{0}' without a number; write '{0} VALUE'", keyword));
  const float result = checked(keyword, *value, highest);
  if (const std::string_view extra = scanner_.word(); !extra.empty()) {
    scanner_.fail(fmt::format("{} after the value of '{}'; remove it", in_quotes(extra), keyword));
  }
  return result;
}

float MtlParser::checked(const std::string& keyword, double value, float highest) {
  if (value >= 0.0 && value <= double{highest}) return static_cast<float>(value);
  const bool bounded = highest == 1.0f;
  scanner_.fail(fmt::format("'{}' is {:g}; give a value {}", keyword, value,
                            bounded ? "from 0 to 1" : "of at least 0 that fits single precision"));
}

}  // namespace

std::vector<MtlMaterial> read_mtl(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  return MtlParser(path, without_byte_order_mark(text)).parse();
}

}  // namespace vrc
