// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace vrc {

/// The records of a picture as a page holds them, before compression.
struct PackedRecords {
  std::size_t count = 0;
  /// For each column its name and how a value follows from 16 bits q: `exponent`: the 16-bit float q times
  /// 2^exponent; `low` and `step`: low + q step; `words`: the q-th of them.
  nlohmann::ordered_json columns;
  std::string bytes;  ///< For each column the high bytes of all records, then the low bytes.
};

/// Reads a record map of `vrc` in .csv; leaves out records that are not near the picture of width x height
/// pixels, and columns that no page shows. Throws InputError, with the line, for anything else.
[[nodiscard]] PackedRecords pack_records(const std::filesystem::path& path, int width, int height);

}  // namespace vrc
