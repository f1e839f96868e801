// SPDX-License-Identifier: GPL-3.0-or-later
#include "hit_mesh.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace vrc {
namespace {

// Keeps the fields of a cell, and the columns, out of each other's cache sets; a multiple of the lanes.
constexpr std::size_t kFieldPadding = 5 * kLanes;
constexpr int kColumnPadding = kLanes;
constexpr std::size_t kFewestInLoop = 3;

/// v[index[i]] for every lane.
F16 permuted(F16 v, I16 index) {
#if defined(__AVX512F__)
  return std::bit_cast<F16>(
      _mm512_maskz_permutexvar_ps(0xffff, std::bit_cast<__m512i>(index), std::bit_cast<__m512>(v)));
#else
  F16 result;
  for (int i = 0; i < kLanes; ++i) result[i] = v[index[i]];
  return result;
#endif
}

}  // namespace

HitGrid::HitGrid(int columns_log2, int rows_log2)
    : columns_(1 << columns_log2),
      rows_(1 << rows_log2),
      stride_(rows_ + kColumnPadding),
      field_size_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(stride_) + kFieldPadding),
      values_([]() -> std::vector<float>& {
        static thread_local std::vector<float> storage;
        return storage;
      }()) {
  values_.resize(kFields * field_size_);
}

void HitGrid::store(F16 u1, F16 u2, const GatherPacket16& packet) {
  // Sixteen points fill a block of 4 x 4 cells in any order [SobolGrid]: sorted, they are four runs.
  const I16 column = to_int(u1 * static_cast<float>(columns_)), row = to_int(u2 * static_cast<float>(rows_));
  const I16 place = (column & 3) * 4 + (row & 3);
  I16 sorted{};
  for (int lane = 0; lane < kLanes; ++lane) sorted[place[lane] & 15] = lane;
  const auto corner = static_cast<std::size_t>(index(column[0] & ~3, row[0] & ~3));
  const F16 brightness = luminance(packet.incident.value);
  const F16 inverse = select(brightness > 0.0f, 1.0f / max(brightness, 1e-30f), F16{});
  const F16 fields[kFields] = {packet.direction.x,
                               packet.direction.y,
                               packet.direction.z,
                               1.0f / packet.distance,
                               packet.tangent_plane.x,
                               packet.tangent_plane.y,
                               packet.tangent_plane.z,
                               packet.incident.value.x,
                               packet.incident.value.y,
                               packet.incident.value.z,
                               luminance(packet.incident.jet.g1) * inverse,
                               luminance(packet.incident.jet.g2) * inverse,
                               packet.u1,
                               packet.u2,
                               from_bits(packet.triangle)};
  for (int f = 0; f < kFields; ++f) {
    float* base = values_.data() + static_cast<std::size_t>(f) * field_size_ + corner;
    const F16 values = permuted(fields[f], sorted);
    for (int run = 0; run < 4; ++run)
      __builtin_memcpy(base + run * stride_, reinterpret_cast<const float*>(&values) + 4 * run,
                       4 * sizeof(float));
  }
}

HitMesh::Storage& HitMesh::thread_storage() {
  static thread_local Storage storage;
  return storage;
}

HitMesh::HitMesh(const HitGrid& grid, const GatherStrategy& strategy)
    : storage_(thread_storage()), azimuth_(grid.field(HitGrid::kSquare2)) {
  storage_.cells.clear();
  storage_.loop_starts.clear();
  for (auto& corners : storage_.corners) corners.clear();
  for (auto& links : storage_.links) links.assign(static_cast<std::size_t>(grid.index_end()), -1);
  make_loops(grid, strategy);
  if (storage_.loop_starts.empty()) return;
  fill_first_loop();
  for (std::size_t i = 0; i + 1 < storage_.loop_starts.size(); ++i) join(i);
}

void HitMesh::make_loops(const HitGrid& grid, const GatherStrategy& strategy) {
  std::vector<int>& cells = storage_.cells;
  const float* u1 = grid.field(HitGrid::kSquare1);
  for (int column = 0; column < grid.columns(); ++column) {
    const std::size_t start = cells.size();
    for (int row = 0; row < grid.rows(); ++row) {
      const int cell = grid.index(column, row);
      if (u1[cell] < strategy.begin || u1[cell] >= strategy.end) continue;
      // Points of one column may lie in two of the guide, of which each has its own order.
      std::size_t place = cells.size();
      cells.push_back(cell);
      for (; place > start && azimuth_[cells[place - 1]] > azimuth_[cell]; --place)
        cells[place] = cells[place - 1];
      cells[place] = cell;
    }
    const std::size_t count = cells.size() - start;
    if (count < kFewestInLoop) {
      cells.resize(start);
      continue;
    }
    storage_.loop_starts.push_back(start);
    for (std::size_t k = 0; k < count; ++k) {
      const int here = cells[start + k], next = cells[start + (k + 1) % count];
      storage_.links[kNext][static_cast<std::size_t>(here)] = next;
      storage_.links[kPrevious][static_cast<std::size_t>(next)] = here;
    }
  }
}

std::span<const int> HitMesh::loop(std::size_t i) const {
  const std::size_t begin = storage_.loop_starts[i];
  const std::size_t end =
      i + 1 < storage_.loop_starts.size() ? storage_.loop_starts[i + 1] : storage_.cells.size();
  return std::span(storage_.cells).subspan(begin, end - begin);
}

void HitMesh::add_triangle(int a, int b, int c) {
  storage_.corners[0].push_back(a);
  storage_.corners[1].push_back(b);
  storage_.corners[2].push_back(c);
}

/// A ladder across the polygon around the axis.
void HitMesh::fill_first_loop() {
  const std::span<const int> cells = loop(0);
  std::size_t low = 0, high = cells.size() - 1;
  while (high - low >= 2) {
    add_triangle(cells[low], cells[low + 1], cells[high]);
    ++low;
    if (high - low < 2) break;
    add_triangle(cells[low], cells[high - 1], cells[high]);
    --high;
  }
}

void HitMesh::join(std::size_t inner_loop) {
  const std::span<const int> inner = loop(inner_loop), outer = loop(inner_loop + 1);
  constexpr float kEnd = std::numeric_limits<float>::infinity();
  // Azimuths go on beyond the whole turn.
  const auto azimuth = [&](std::span<const int> cells, std::size_t k) {
    const std::size_t n = cells.size();
    return k < n ? azimuth_[cells[k]] : k == n ? azimuth_[cells[0]] + 1.0f : kEnd;
  };
  const auto link = [&](Link to, std::span<const int> from_cells, std::size_t k,
                        std::span<const int> to_cells, std::size_t below) {
    const float here = azimuth(from_cells, k);
    const bool up = azimuth(to_cells, below + 1) - here < here - azimuth(to_cells, below);
    const std::size_t n = to_cells.size();
    storage_.links[to][static_cast<std::size_t>(from_cells[k])] = to_cells[(below + (up ? 1 : 0)) % n];
  };
  std::size_t i = 0, o = 0;
  link(kOuter, inner, 0, outer, 0);
  link(kInner, outer, 0, inner, 0);
  while (i < inner.size() || o < outer.size()) {
    if (azimuth(inner, i + 1) <= azimuth(outer, o + 1)) {
      add_triangle(inner[i % inner.size()], outer[o % outer.size()], inner[(i + 1) % inner.size()]);
      if (++i < inner.size()) link(kOuter, inner, i, outer, o);
    } else {
      add_triangle(inner[i % inner.size()], outer[o % outer.size()], outer[(o + 1) % outer.size()]);
      if (++o < outer.size()) link(kInner, outer, o, inner, i);
    }
  }
}

HitMesh::Triangles16 HitMesh::triangles(std::size_t first) const {
  Triangles16 result;
  const std::size_t last = triangle_count() - 1;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::int32_t* from = storage_.corners[corner].data();
    for (int lane = 0; lane < kLanes; ++lane)
      result[corner][lane] = from[std::min(first + static_cast<std::size_t>(lane), last)];
  }
  return result;
}

}  // namespace vrc
