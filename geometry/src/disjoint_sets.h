// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace vrc {

/// Union-find whose representative is always the smallest member, so that labels do not depend on
/// the order of the unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }

  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a < b) std::swap(a, b);
    parent_[a] = b;
  }

  /// Per member its set's number; sets are numbered by their smallest members.
  std::vector<std::uint32_t> labels() {
    std::vector<std::uint32_t> label(parent_.size());
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < label.size(); ++i) {
      const std::uint32_t root = find(i);
      label[i] = root == i ? count++ : label[root];
    }
    return label;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace vrc
