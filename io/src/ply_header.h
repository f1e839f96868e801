// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vrc {

enum class PlyFormat { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

/// Bytes of a value in a binary body.
[[nodiscard]] std::size_t size_of(PlyType type);
[[nodiscard]] bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;   ///< Of the value, or of each entry of a list.
  std::optional<PlyType> count_type;  ///< Of the length in front of a list; nothing for a scalar.
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< As promised; `check_counts` compares it with the file.
  std::vector<PlyProperty> properties;
  std::size_t line = 0;  ///< Of its statement in the header.
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;  ///< In the order of the body; names differ.
  std::string_view body;             ///< Into the text that was parsed.
  std::size_t body_line = 0;         ///< Line number at which the body begins.
};

/// Parses the header of a PLY file whose content is `text`; `file` is for messages. Throws InputError
/// with the line of the statement that is malformed.
[[nodiscard]] PlyHeader parse_ply_header(const std::string& file, std::string_view text);

/// Throws InputError when the body is too short for what the header promises, before anything is
/// allocated for it: by lines for ascii, by the least bytes of each row for binary bodies.
void check_counts(const std::string& file, const PlyHeader& header);

}  // namespace vrc
