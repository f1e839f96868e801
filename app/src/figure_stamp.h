// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "figure.h"

namespace vrc {

/// What a finished panel says of itself in ID.json, so that it need not be made again.
struct PanelStamp {
  std::uint64_t key = 0;  ///< Of everything that its files depend on.
  std::string command;
  std::vector<std::string>
      files;  ///< Names in the figure's folder; the first is the picture. Points have none.
  NamedNumbers numbers;
};

/// The stamp of a panel that was made with this key and whose files are all there; else nothing.
[[nodiscard]] std::optional<PanelStamp> read_stamp(const std::filesystem::path& folder, const std::string& id,
                                                   std::uint64_t key);
/// To be written when the files are. Throws InputError.
void write_stamp(const std::filesystem::path& folder, const std::string& id, const PanelStamp& stamp);

/// Before the files are written anew.
void remove_stamp(const std::filesystem::path& folder, const std::string& id);

/// Continues the hash `key` by bytes.
[[nodiscard]] std::uint64_t hash_bytes(std::uint64_t key, std::string_view bytes);
/// Continues the hash `key` by the contents of files. Throws InputError when one cannot be read.
[[nodiscard]] std::uint64_t hash_files(std::uint64_t key, const std::vector<std::filesystem::path>& files);

}  // namespace vrc
