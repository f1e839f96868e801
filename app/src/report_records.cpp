// SPDX-License-Identifier: GPL-3.0-or-later
#include "report_records.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "record_table.h"
#include "report_pack.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr std::array kPlaces = {"px", "py"};
constexpr std::array<std::string_view, 6> kRequired = {"px", "py", "p1x", "p1y", "p2x", "p2y"};
constexpr std::array kNumbers = {"p1x", "p1y", "p2x",      "p2y", "r1", "r2",   "L_r",
                                 "L_g", "L_b", "L_stddev", "g1",  "g2", "rays", "is_sh"};
constexpr std::array kWords = {"reason", "sh_reason"};

/// The values of the columns that are shown, record by record.
struct RecordColumns {
  std::map<std::string, std::vector<float>> numbers;
  std::map<std::string, std::vector<std::string>> words;
  std::size_t count = 0;
};

/// Within one picture beyond each border.
bool is_near(float x, float y, int width, int height) {
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  return x >= -w && x <= 2.0f * w && y >= -h && y <= 2.0f * h;
}

RecordColumns read_columns(const fs::path& path, int width, int height) {
  RecordTable table(path, kRequired);
  RecordColumns columns;
  while (table.next()) {
    if (!is_near(table.number<float>("px"), table.number<float>("py"), width, height)) continue;
    for (const char* name : kPlaces) columns.numbers[name].push_back(table.number<float>(name));
    for (const char* name : kNumbers) {
      if (table.has(name)) columns.numbers[name].push_back(table.number<float>(name));
    }
    for (const char* name : kWords) {
      if (table.has(name)) columns.words[name].emplace_back(table.word(name));
    }
    ++columns.count;
  }
  return columns;
}

void append_place(PackedRecords& packed, const char* name, const std::vector<float>& values, int size) {
  const double low = -size, step = 3.0 * size / 65535.0;
  std::vector<std::uint16_t> bits;
  bits.reserve(values.size());
  for (const float v : values)
    bits.push_back(static_cast<std::uint16_t>(std::clamp(std::round((v - low) / step), 0.0, 65535.0)));
  packed.columns.push_back({{"name", name}, {"low", low}, {"step", step}});
  packed.bytes += split_bytes(bits);
}

void append_numbers(PackedRecords& packed, const std::string& name, const std::vector<float>& values) {
  const HalfScale scale(values);
  std::vector<std::uint16_t> bits;
  bits.reserve(values.size());
  for (const float v : values) bits.push_back(scale(v));
  packed.columns.push_back({{"name", name}, {"exponent", scale.exponent}});
  packed.bytes += split_bytes(bits);
}

void append_words(PackedRecords& packed, const std::string& name, const std::vector<std::string>& values) {
  std::vector<std::string> words;
  std::vector<std::uint16_t> bits;
  bits.reserve(values.size());
  for (const std::string& value : values) {
    const auto found = std::ranges::find(words, value);
    bits.push_back(static_cast<std::uint16_t>(found - words.begin()));
    if (found == words.end()) words.push_back(value);
  }
  packed.columns.push_back({{"name", name}, {"words", words}});
  packed.bytes += split_bytes(bits);
}

}  // namespace

PackedRecords pack_records(const fs::path& path, int width, int height) {
  const RecordColumns columns = read_columns(path, width, height);
  PackedRecords packed{columns.count, nlohmann::ordered_json::array(), {}};
  if (columns.count == 0) return packed;
  append_place(packed, "px", columns.numbers.at("px"), width);
  append_place(packed, "py", columns.numbers.at("py"), height);
  for (const char* name : kNumbers) {
    if (columns.numbers.contains(name)) append_numbers(packed, name, columns.numbers.at(name));
  }
  for (const char* name : kWords) {
    if (columns.words.contains(name)) append_words(packed, name, columns.words.at(name));
  }
  return packed;
}

}  // namespace vrc
