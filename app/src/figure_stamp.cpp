// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_stamp.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/version.h"
#include "core/error.h"
#include "core/hash.h"
#include "io/atomic_file.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "vrc figure panel 1";

fs::path stamp_path(const fs::path& folder, const std::string& id) { return folder / (id + ".json"); }

std::optional<std::string> content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path)) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

PanelStamp stamp_of(const Json& json) {
  PanelStamp stamp;
  stamp.key = json.at("key").get<std::uint64_t>();
  stamp.command = json.at("command").get<std::string>();
  stamp.files = json.at("files").get<std::vector<std::string>>();
  for (const auto& [name, value] : json.at("ours").items()) stamp.numbers.emplace_back(name, value);
  return stamp;
}

}  // namespace

std::optional<PanelStamp> read_stamp(const fs::path& folder, const std::string& id, std::uint64_t key) {
  const std::optional<std::string> text = content_of(stamp_path(folder, id));
  if (!text) return std::nullopt;
  try {
    const Json json = Json::parse(*text);
    if (json.at("format") != kFormat || json.at("version") != kVersion) return std::nullopt;
    PanelStamp stamp = stamp_of(json);
    const auto there = [&](const std::string& file) { return fs::is_regular_file(folder / file); };
    if (stamp.key != key || !std::ranges::all_of(stamp.files, there)) return std::nullopt;
    return stamp;
  } catch (const Json::exception&) {  // damaged: the panel is made again
    return std::nullopt;
  }
}

void write_stamp(const fs::path& folder, const std::string& id, const PanelStamp& stamp) {
  Json numbers = Json::object();
  for (const auto& [name, value] : stamp.numbers) numbers[name] = value;
  const Json json{{"format", kFormat},        {"version", kVersion},  {"key", stamp.key},
                  {"command", stamp.command}, {"files", stamp.files}, {"ours", std::move(numbers)}};
  write_file_atomically(stamp_path(folder, id), json.dump(2) + "\n");
}

void remove_stamp(const fs::path& folder, const std::string& id) {
  std::error_code error;  // one that stays is found out by its key
  fs::remove(stamp_path(folder, id), error);
}

std::uint64_t hash_bytes(std::uint64_t key, std::string_view bytes) {
  std::uint64_t result = hash(key, bytes.size());
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min(sizeof word, bytes.size() - i));
    result = mix(result ^ word);
  }
  return result;
}

std::uint64_t hash_files(std::uint64_t key, const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    const std::optional<std::string> content = content_of(file);
    if (!content) throw InputError(file.string(), 0, "cannot be read");
    key = hash_bytes(key, *content);
  }
  return key;
}

}  // namespace vrc
