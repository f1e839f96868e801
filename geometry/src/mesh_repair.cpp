// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_repair.h"

#include <algorithm>

#include "disjoint_sets.h"
#include "polygon_cleanup.h"

namespace vrc {
namespace {

constexpr std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

std::uint32_t vertex_at(const RepairedMesh& mesh, std::uint32_t corner) {
  return mesh.triangles[corner / 3][corner % 3];
}

// A triangle's edge is named by the corner where it starts. `opposite` is the same edge in the other
// triangle, or kInvalidIndex where there is none or not exactly one.
struct EdgeLinks {
  std::vector<std::uint32_t> opposite;
  std::vector<std::uint8_t> non_manifold;  ///< 1 where three or more triangles meet.
  std::size_t non_manifold_count = 0;      ///< Counting each such edge once.
};

// Corners sorted by the smaller vertex of the edge that starts there: counting sort.
struct EdgeBuckets {
  std::vector<std::uint32_t> begin;    ///< Per vertex.
  std::vector<std::uint64_t> entries;  ///< (larger vertex << 32) | corner.
};

EdgeBuckets bucket_edges(const RepairedMesh& mesh) {
  EdgeBuckets buckets;
  const auto corners = static_cast<std::uint32_t>(3 * mesh.triangles.size());
  buckets.begin.assign(mesh.positions.size() + 2, 0);
  for (std::uint32_t c = 0; c < corners; ++c) {
    const std::uint32_t a = vertex_at(mesh, c);
    const std::uint32_t b = vertex_at(mesh, next_corner(c));
    ++buckets.begin[std::min(a, b) + 2];
  }
  for (std::size_t v = 2; v < buckets.begin.size(); ++v) buckets.begin[v] += buckets.begin[v - 1];
  buckets.entries.resize(corners);
  for (std::uint32_t c = 0; c < corners; ++c) {
    const std::uint32_t a = vertex_at(mesh, c);
    const std::uint32_t b = vertex_at(mesh, next_corner(c));
    buckets.entries[buckets.begin[std::min(a, b) + 1]++] = (std::uint64_t{std::max(a, b)} << 32) | c;
  }
  return buckets;
}

EdgeLinks link_edges(const RepairedMesh& mesh) {
  EdgeBuckets buckets = bucket_edges(mesh);
  EdgeLinks links;
  links.opposite.assign(3 * mesh.triangles.size(), kInvalidIndex);
  links.non_manifold.assign(3 * mesh.triangles.size(), 0);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto first = buckets.entries.begin() + buckets.begin[v];
    const auto last = buckets.entries.begin() + buckets.begin[v + 1];
    std::sort(first, last);
    for (auto group = first; group != last;) {
      const auto group_end =
          std::find_if(group, last, [&](std::uint64_t e) { return e >> 32 != *group >> 32; });
      if (group_end - group == 2) {
        const auto a = static_cast<std::uint32_t>(group[0]);
        const auto b = static_cast<std::uint32_t>(group[1]);
        links.opposite[a] = b;
        links.opposite[b] = a;
      } else if (group_end - group > 2) {
        ++links.non_manifold_count;
        for (auto e = group; e != group_end; ++e) links.non_manifold[static_cast<std::uint32_t>(*e)] = 1;
      }
      group = group_end;
    }
  }
  return links;
}

// Linked triangles, with the turns that make their orientations agree.
struct Component {
  std::vector<std::uint32_t> faces;
  std::size_t flips = 0;
  bool closed = true;
};

class Orienter {
 public:
  Orienter(RepairedMesh& mesh, EdgeLinks& links)
      : mesh_(mesh), links_(links), visited_(mesh.triangles.size(), 0) {}

  void orient(bool outward) {
    for (std::uint32_t seed = 0; seed < visited_.size(); ++seed) {
      if (visited_[seed] != 0) continue;
      const Component component = flood(seed);
      bool reverse = 2 * component.flips > component.faces.size();
      if (outward && component.closed) reverse = signed_volume(component) < 0.0;
      if (!reverse) continue;
      for (const std::uint32_t f : component.faces) mesh_.flipped[f] ^= 1;
    }
    apply_flips();
  }

 private:
  // Breadth first, so that a contradiction is met far from the seed and the cut stays short.
  Component flood(std::uint32_t seed) {
    Component component;
    component.faces.push_back(seed);
    visited_[seed] = 1;
    for (std::size_t i = 0; i < component.faces.size(); ++i) {
      const std::uint32_t f = component.faces[i];
      component.flips += mesh_.flipped[f];
      for (std::uint32_t c = 3 * f; c < 3 * f + 3; ++c) {
        const std::uint32_t other = links_.opposite[c];
        if (other == kInvalidIndex) {
          component.closed = component.closed && links_.non_manifold[c] != 0;
          continue;
        }
        const std::uint32_t g = other / 3;
        const bool same_direction = vertex_at(mesh_, c) == vertex_at(mesh_, other);
        const auto wanted = static_cast<std::uint8_t>(mesh_.flipped[f] ^ (same_direction ? 1 : 0));
        if (visited_[g] == 0) {
          visited_[g] = 1;
          mesh_.flipped[g] = wanted;
          component.faces.push_back(g);
        } else if (mesh_.flipped[g] != wanted) {
          cut(c, other);
          component.closed = false;
        }
      }
    }
    return component;
  }

  void cut(std::uint32_t a, std::uint32_t b) {
    links_.opposite[a] = links_.opposite[b] = kInvalidIndex;
    mesh_.detached_edge[a] = mesh_.detached_edge[b] = 1;
    ++mesh_.report.orientation_cuts;
  }

  double signed_volume(const Component& component) const {
    const Vec3 origin = mesh_.positions[mesh_.triangles[component.faces.front()][0]];
    double volume = 0.0;
    for (const std::uint32_t f : component.faces) {
      const auto& [a, b, c] = mesh_.triangles[f];
      const Vec3 pa = mesh_.positions[a] - origin;
      const double tetrahedron = pa.dot((mesh_.positions[b] - origin).cross(mesh_.positions[c] - origin));
      volume += mesh_.flipped[f] != 0 ? -tetrahedron : tetrahedron;
    }
    return volume;
  }

  // A reversed triangle keeps its first corner; its edges 0 and 2 change places.
  void apply_flips() {
    for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
      if (mesh_.flipped[f] == 0) continue;
      ++mesh_.report.flipped_faces;
      const std::size_t c = 3 * f;
      std::swap(mesh_.triangles[f][1], mesh_.triangles[f][2]);
      std::swap(mesh_.source_corner[c + 1], mesh_.source_corner[c + 2]);
      std::swap(mesh_.detached_edge[c], mesh_.detached_edge[c + 2]);
      std::swap(links_.opposite[c], links_.opposite[c + 2]);
      std::swap(links_.non_manifold[c], links_.non_manifold[c + 2]);
    }
    for (std::uint32_t& other : links_.opposite) {
      if (other == kInvalidIndex || mesh_.flipped[other / 3] == 0) continue;
      other = other / 3 * 3 + (2 - other % 3);
    }
  }

  RepairedMesh& mesh_;
  EdgeLinks& links_;
  std::vector<std::uint8_t> visited_;
};

// The corners that share a vertex after detaching: joined across linked edges only, so that each set
// is a single fan of triangles.
std::vector<std::uint32_t> fans(const EdgeLinks& links) {
  DisjointSets sets(links.opposite.size());
  for (std::uint32_t c = 0; c < links.opposite.size(); ++c) {
    const std::uint32_t other = links.opposite[c];
    if (other == kInvalidIndex || other < c) continue;
    sets.unite(c, next_corner(other));
    sets.unite(next_corner(c), other);
  }
  std::vector<std::uint32_t> fan(links.opposite.size());
  for (std::uint32_t c = 0; c < fan.size(); ++c) fan[c] = sets.find(c);
  return fan;
}

// Gives every fan its own vertex and drops vertices without faces.
void split_vertices(RepairedMesh& mesh, const EdgeLinks& links) {
  const std::vector<std::uint32_t> fan = fans(links);
  std::vector<std::uint32_t> first_fan(mesh.positions.size(), kInvalidIndex);
  std::vector<std::uint8_t> on_cut(mesh.positions.size(), 0);
  for (std::uint32_t c = 0; c < fan.size(); ++c) {
    const std::uint32_t v = vertex_at(mesh, c);
    if (first_fan[v] == kInvalidIndex) first_fan[v] = fan[c];
    if (mesh.detached_edge[c] != 0) on_cut[v] = on_cut[vertex_at(mesh, next_corner(c))] = 1;
  }

  std::vector<Vec3> positions;
  positions.reserve(mesh.positions.size());
  std::vector<std::uint32_t> vertex_of_fan(fan.size(), kInvalidIndex);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (first_fan[v] == kInvalidIndex) {
      ++mesh.report.isolated_vertices;
      continue;
    }
    vertex_of_fan[first_fan[v]] = static_cast<std::uint32_t>(positions.size());
    positions.push_back(mesh.positions[v]);
  }
  std::vector<std::uint8_t> is_bow_tie(mesh.positions.size(), 0);
  for (std::uint32_t c = 0; c < fan.size(); ++c) {
    std::uint32_t& vertex = mesh.triangles[c / 3][c % 3];
    if (vertex_of_fan[fan[c]] == kInvalidIndex) {
      vertex_of_fan[fan[c]] = static_cast<std::uint32_t>(positions.size());
      positions.push_back(mesh.positions[vertex]);
      ++mesh.report.vertex_copies;
      is_bow_tie[vertex] = on_cut[vertex] == 0 ? 1 : 0;
    }
    vertex = vertex_of_fan[fan[c]];
  }
  mesh.report.non_manifold_vertices =
      static_cast<std::size_t>(std::count(is_bow_tie.begin(), is_bow_tie.end(), std::uint8_t{1}));
  mesh.positions = std::move(positions);
}

}  // namespace

RepairedMesh repair_mesh(const PolygonSoup& soup, const RepairOptions& options) {
  RepairedMesh mesh = clean_polygons(soup, options.weld_tolerance);
  EdgeLinks links = link_edges(mesh);
  mesh.detached_edge = links.non_manifold;
  mesh.report.non_manifold_edges = links.non_manifold_count;
  Orienter(mesh, links).orient(options.orient_outward);
  split_vertices(mesh, links);
  return mesh;
}

}  // namespace vrc
