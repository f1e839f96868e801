// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_mesh.h"

#include <algorithm>

#include "disjoint_sets.h"

namespace vrc {
namespace {

// Fills triangles and positions from the neighbours.
template <typename CornerPosition>
void join_corners(ChartMesh& chart, const CornerPosition& corner_position) {
  const std::size_t count = chart.neighbours.size();
  DisjointSets sets(3 * count);
  for (std::uint32_t f = 0; f < count; ++f) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t other = chart.neighbours[f][k];
      if (other == kInvalidIndex || other < f) continue;
      // Two faces may share two edges: take the one that runs backwards along ours.
      const Vec3 begin = corner_position(f, k);
      const Vec3 end = corner_position(f, (k + 1) % 3);
      for (std::uint32_t j = 0; j < 3; ++j) {
        if (chart.neighbours[other][j] != f || corner_position(other, j) != end ||
            corner_position(other, (j + 1) % 3) != begin) {
          continue;
        }
        sets.unite(3 * f + k, 3 * other + (j + 1) % 3);
        sets.unite(3 * f + (k + 1) % 3, 3 * other + j);
      }
    }
  }
  const std::vector<std::uint32_t> vertex = sets.labels();
  chart.triangles.resize(count);
  chart.positions.clear();
  for (std::uint32_t c = 0; c < vertex.size(); ++c) {
    chart.triangles[c / 3][c % 3] = vertex[c];
    if (vertex[c] == chart.positions.size()) chart.positions.push_back(corner_position(c / 3, c % 3));
  }
}

}  // namespace

bool ChartMesh::has_boundary() const {
  return std::any_of(neighbours.begin(), neighbours.end(), [](const auto& around) {
    return std::find(around.begin(), around.end(), kInvalidIndex) != around.end();
  });
}

ChartMesh make_chart_mesh(const SurfaceMesh& mesh, const FaceGraph& graph,
                          std::span<const std::uint32_t> faces, std::span<const std::uint32_t> chart_of,
                          std::vector<std::uint32_t>& local) {
  ChartMesh chart;
  chart.source.assign(faces.begin(), faces.end());
  for (std::uint32_t i = 0; i < faces.size(); ++i) local[faces[i]] = i;
  for (const std::uint32_t f : faces) {
    auto& around = chart.neighbours.emplace_back();
    auto& smooth = chart.smooth.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const std::uint32_t n = mesh.neighbour(f, k);
      const bool inside = n != kInvalidIndex && chart_of[n] == chart_of[f];
      around[i] = inside ? local[n] : kInvalidIndex;
      smooth[i] = inside && graph.neighbour[f][i] != kInvalidIndex;
    }
  }
  join_corners(chart,
               [&](std::size_t f, std::size_t k) { return mesh.position(mesh.triangle(faces[f])[k]); });
  return chart;
}

std::vector<ChartMesh> cut_chart(const ChartMesh& chart, std::span<const std::uint32_t> label) {
  DisjointSets sets(chart.size());
  for (std::uint32_t f = 0; f < chart.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t n = chart.neighbours[f][k];
      if (chart.smooth[f][k] && label[n] == label[f]) sets.unite(f, n);
    }
  }
  const std::vector<std::uint32_t> part_of = sets.labels();
  std::vector<std::vector<std::uint32_t>> members;
  std::vector<std::uint32_t> local(chart.size());
  for (std::uint32_t f = 0; f < chart.size(); ++f) {
    if (part_of[f] == members.size()) members.emplace_back();
    local[f] = static_cast<std::uint32_t>(members[part_of[f]].size());
    members[part_of[f]].push_back(f);
  }
  std::vector<ChartMesh> parts(members.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const std::uint32_t f : members[p]) {
      parts[p].source.push_back(chart.source[f]);
      auto& around = parts[p].neighbours.emplace_back(chart.neighbours[f]);
      auto& smooth = parts[p].smooth.emplace_back(chart.smooth[f]);
      for (std::size_t k = 0; k < 3; ++k) {
        const bool inside = around[k] != kInvalidIndex && part_of[around[k]] == p;
        around[k] = inside ? local[around[k]] : kInvalidIndex;
        smooth[k] = smooth[k] && inside;
      }
    }
    join_corners(parts[p], [&](std::size_t f, std::size_t k) {
      return chart.positions[chart.triangles[members[p][f]][k]];
    });
  }
  return parts;
}

}  // namespace vrc
