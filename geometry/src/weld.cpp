// SPDX-License-Identifier: GPL-3.0-or-later
#include "weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace vrc {
namespace {

using Cell = std::array<std::int64_t, 3>;

std::uint64_t mix(std::uint64_t h) {  // finaliser of MurmurHash3
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdULL;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ULL;
  return h ^ (h >> 33);
}

std::uint64_t hash_cell(const Cell& cell) {
  std::uint64_t h = 0;
  for (const std::int64_t c : cell) h = mix(h + 0x9e3779b97f4a7c15ULL + std::bit_cast<std::uint64_t>(c));
  return h;
}

// Distinct positions chained by the hash of their cell: the bits of the coordinates for exact
// welding, a cube as wide as the tolerance otherwise.
class PositionTable {
 public:
  PositionTable(std::size_t capacity, double tolerance, const Vec3& origin)
      : tolerance_(tolerance), origin_(origin), heads_(std::bit_ceil(2 * capacity + 1), kInvalidIndex) {
    next_.reserve(capacity);
    positions_.reserve(capacity);
  }

  std::uint32_t find_or_add(const Vec3& p) {
    const Cell cell = cell_of(p);
    const std::uint32_t found = tolerance_ > 0.0 ? nearest_cells(p, cell) : in_chain(p, hash_cell(cell));
    if (found != kInvalidIndex) return found;
    std::uint32_t& head = heads_[hash_cell(cell) & (heads_.size() - 1)];
    next_.push_back(head);
    head = static_cast<std::uint32_t>(positions_.size());
    positions_.push_back(p);
    return head;
  }

  std::vector<Vec3> take_positions() { return std::move(positions_); }

 private:
  Cell cell_of(const Vec3& p) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      cell[i] = tolerance_ > 0.0
                    ? std::llround(std::clamp((p[axis] - origin_[axis]) / tolerance_, -9e15, 9e15))
                    : std::bit_cast<std::int64_t>(p[axis] + 0.0);  // + 0.0 turns -0 into 0
    }
    return cell;
  }

  // The earliest position within the tolerance.
  std::uint32_t in_chain(const Vec3& p, std::uint64_t hash) const {
    std::uint32_t earliest = kInvalidIndex;
    for (std::uint32_t i = heads_[hash & (heads_.size() - 1)]; i != kInvalidIndex; i = next_[i]) {
      const bool same = tolerance_ > 0.0 ? (positions_[i] - p).squaredNorm() <= tolerance_ * tolerance_
                                         : positions_[i] == p;
      if (same) earliest = std::min(earliest, i);
    }
    return earliest;
  }

  std::uint32_t nearest_cells(const Vec3& p, const Cell& cell) const {
    std::uint32_t earliest = kInvalidIndex;
    for (int n = 0; n < 27; ++n) {
      const Cell near = {cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
      earliest = std::min(earliest, in_chain(p, hash_cell(near)));
    }
    return earliest;
  }

  double tolerance_;
  Vec3 origin_;
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
  std::vector<Vec3> positions_;
};

}  // namespace

WeldedPositions weld_positions(std::span<const Vec3> positions, double tolerance) {
  if (positions.empty()) return {};
  PositionTable table(positions.size(), tolerance, positions.front());
  WeldedPositions welded;
  welded.vertex_of.reserve(positions.size());
  for (const Vec3& p : positions) welded.vertex_of.push_back(table.find_or_add(p));
  welded.positions = table.take_positions();
  return welded;
}

}  // namespace vrc
