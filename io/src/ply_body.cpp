// SPDX-License-Identifier: GPL-3.0-or-later
#include "ply_body.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/error.h"

namespace vrc {

void AsciiPlyBody::begin_row(const PlyElement& element, std::uint64_t row) {
  if (!scanner_.next_line()) {
    fail(fmt::format("the file ends after {} of {} of element '{}'; export it again", row, element.count,
                     element.name));
  }
}

double AsciiPlyBody::scalar(PlyType type) {
  const std::optional<double> value = scanner_.number();
  if (!value) fail_short_row();
  if (is_integer(type) && *value != std::floor(*value)) {
    fail(fmt::format("{} stands where the header promises a whole number; correct it", *value));
  }
  return *value;
}

std::uint64_t AsciiPlyBody::list_length(const PlyProperty& list) {
  const double length = scalar(*list.count_type);
  if (length < 0.0 || length > 4294967295.0) {
    fail(fmt::format("list '{}' has the length {}; correct it", list.name, length));
  }
  return static_cast<std::uint64_t>(length);
}

void AsciiPlyBody::skip(PlyType, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (scanner_.word().empty()) fail_short_row();
  }
}

void AsciiPlyBody::end_row() {
  if (const std::string_view extra = scanner_.word(); !extra.empty()) {
    fail(in_quotes(extra) + " is more than the header promises for this line; remove it");
  }
}

void AsciiPlyBody::finish() {
  if (scanner_.next_line()) {
    fail(in_quotes(scanner_.word()) +
         " follows the last element that the header promises; correct the counts");
  }
}

void AsciiPlyBody::fail_short_row() const {
  fail("the line ends before the values that the header promises; complete it");
}

BinaryPlyBody::BinaryPlyBody(const std::string& file, const PlyHeader& header)
    : file_(file), cursor_(header.body.data()), end_(header.body.data() + header.body.size()) {
  const bool little_file = header.format == PlyFormat::kBinaryLittleEndian;
  swap_bytes_ = little_file != (std::endian::native == std::endian::little);
}

double BinaryPlyBody::scalar(PlyType type) {
  require_bytes(1, size_of(type));
  switch (type) {
    case PlyType::kInt8:
      return load<std::int8_t>();
    case PlyType::kUint8:
      return load<std::uint8_t>();
    case PlyType::kInt16:
      return load<std::int16_t>();
    case PlyType::kUint16:
      return load<std::uint16_t>();
    case PlyType::kInt32:
      return load<std::int32_t>();
    case PlyType::kUint32:
      return load<std::uint32_t>();
    case PlyType::kFloat32:
      return load<float>();
    case PlyType::kFloat64:
      return load<double>();
  }
  VRC_CHECK(false, "PLY type {}", static_cast<int>(type));
}

std::uint64_t BinaryPlyBody::list_length(const PlyProperty& list) {
  const double length = scalar(*list.count_type);
  if (length < 0.0) fail(fmt::format("list '{}' has the length {}; repair the file", list.name, length));
  const auto count = static_cast<std::uint64_t>(length);
  require_bytes(count, size_of(list.type));
  return count;
}

void BinaryPlyBody::skip(PlyType type, std::uint64_t count) {
  require_bytes(count, size_of(type));
  cursor_ += count * size_of(type);
}

void BinaryPlyBody::finish() {
  if (cursor_ == end_) return;
  throw InputError(file_, 0,
                   fmt::format("{} bytes follow the last element that the header promises; the counts or "
                               "types of the header are wrong, so export the file again",
                               end_ - cursor_));
}

void BinaryPlyBody::fail(const std::string& problem) const {
  throw InputError(file_, 0,
                   fmt::format("{} {} of {}: {}", element_->name, row_ + 1, element_->count, problem));
}

// Assembles bytes, so that neither alignment nor the byte order of the machine matters.
template <typename Value>
Value BinaryPlyBody::load() {
  std::array<char, sizeof(Value)> bytes;
  std::memcpy(bytes.data(), cursor_, sizeof(Value));
  cursor_ += sizeof(Value);
  if (swap_bytes_) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Value>(bytes);
}

void BinaryPlyBody::require_bytes(std::uint64_t count, std::size_t size) const {
  const auto left = static_cast<std::uint64_t>(end_ - cursor_);
  if (count <= left / size) return;
  throw InputError(file_, 0,
                   fmt::format("the file ends after {} of {} of element '{}'; it is truncated or a list "
                               "length is wrong, so export it again",
                               row_, element_->count, element_->name));
}

}  // namespace vrc
