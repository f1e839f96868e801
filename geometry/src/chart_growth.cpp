// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_growth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace vrc {
namespace {

constexpr double kFlatCosine = 0.99984769515639124;  // One degree.

struct Chart {
  std::vector<std::uint32_t> faces;
  Vec3 axis = Vec3::UnitZ();
  double area = 0.0;
};

double cosine_of(double degrees) { return std::cos(degrees * kPi / 180.0); }

Vec3 mean_normal(const FaceGraph& graph, const std::vector<std::uint32_t>& faces) {
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t f : faces) sum += graph.area[f] * graph.normal[f];
  const double length = sum.norm();
  return length > 0.0 ? Vec3(sum / length) : graph.normal[faces.front()];
}

class ChartGrower {
 public:
  ChartGrower(const SurfaceMesh& mesh, const FaceGraph& graph, const PatchAtlasOptions& options)
      : mesh_(mesh),
        graph_(graph),
        options_(options),
        chart_of_(graph.size(), kInvalidIndex),
        reached_by_(graph.size(), 0),
        region_flat_(mesh.region_count(), 1),
        region_area_(mesh.region_count(), 0.0) {
    measure_regions();
  }

  std::vector<std::vector<std::uint32_t>> charts() {
    for (std::uint32_t seed = 0; seed < graph_.size(); ++seed) {
      if (chart_of_[seed] == kInvalidIndex) add_chart(seed);
    }
    constexpr int kMaxRounds = 8;
    for (int round = 0; round < kMaxRounds && merge_tiny_charts(); ++round) {
    }
    for (int round = 0; round < kMaxRounds && smooth_borders(); ++round) {
    }
    collect_faces();
    std::vector<std::vector<std::uint32_t>> result;
    for (Chart& chart : charts_) {
      if (chart.faces.empty()) continue;
      result.push_back(std::move(chart.faces));
    }
    return result;
  }

 private:
  void measure_regions() {
    std::vector<Vec3> sums(mesh_.region_count(), Vec3::Zero());
    for (std::size_t f = 0; f < graph_.size(); ++f) {
      sums[mesh_.region(f)] += graph_.area[f] * graph_.normal[f];
      region_area_[mesh_.region(f)] += graph_.area[f];
    }
    for (std::size_t f = 0; f < graph_.size(); ++f) {
      const Vec3& sum = sums[mesh_.region(f)];
      if (!(graph_.normal[f].dot(sum) >= kFlatCosine * sum.norm())) region_flat_[mesh_.region(f)] = 0;
    }
  }

  // Free faces connected with the seed whose normals lie in the cone, nearest first.
  std::vector<std::uint32_t> reach(std::uint32_t seed, const Vec3& axis) {
    const bool flat = region_flat_[mesh_.region(seed)] != 0;
    const double min_cosine = flat ? -2.0 : cosine_of(options_.cone_angle);
    const std::size_t limit = flat ? graph_.size() : std::max<std::size_t>(1, options_.max_faces);
    ++query_;
    reached_by_[seed] = query_;
    std::vector<std::uint32_t> faces{seed};
    for (std::size_t i = 0; i < faces.size() && faces.size() < limit; ++i) {
      for (const std::uint32_t next : graph_.neighbour[faces[i]]) {
        if (next == kInvalidIndex || reached_by_[next] == query_ || chart_of_[next] != kInvalidIndex)
          continue;
        if (!(graph_.normal[next].dot(axis) >= min_cosine)) continue;
        reached_by_[next] = query_;
        faces.push_back(next);
        if (faces.size() == limit) break;
      }
    }
    return faces;
  }

  // A first growth around the seed's normal finds the axis of the second. The mean of normals within
  // a cone around the seed's stays within it, so the seed remains in the chart.
  void add_chart(std::uint32_t seed) {
    Chart chart;
    chart.axis = mean_normal(graph_, reach(seed, graph_.normal[seed]));
    chart.faces = reach(seed, chart.axis);
    for (const std::uint32_t f : chart.faces) {
      chart_of_[f] = static_cast<std::uint32_t>(charts_.size());
      chart.area += graph_.area[f];
    }
    charts_.push_back(std::move(chart));
  }

  bool is_tiny(const Chart& chart) const {
    return chart.faces.size() < options_.tiny_faces ||
           chart.area < options_.tiny_area_share * region_area_[mesh_.region(chart.faces.front())];
  }

  // Smallest first; true when a chart was merged.
  bool merge_tiny_charts() {
    std::vector<std::uint32_t> order;
    for (std::uint32_t c = 0; c < charts_.size(); ++c) {
      if (!charts_[c].faces.empty() && is_tiny(charts_[c])) order.push_back(c);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return charts_[a].area < charts_[b].area; });
    bool merged = false;
    for (const std::uint32_t c : order) {
      if (!is_tiny(charts_[c])) continue;
      const std::uint32_t target = best_neighbour(c);
      if (target == kInvalidIndex) continue;
      merge(c, target);
      merged = true;
    }
    return merged;
  }

  // Across the longest border, if all of the chart lies within the neighbour's wider cone.
  std::uint32_t best_neighbour(std::uint32_t c) const {
    const std::vector<std::uint32_t>& faces = charts_[c].faces;
    std::map<std::uint32_t, double> border;
    for (const std::uint32_t f : faces) {
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t next = graph_.neighbour[f][static_cast<std::size_t>(k)];
        if (next == kInvalidIndex || chart_of_[next] == c) continue;
        const Triangle& t = mesh_.triangle(f);
        border[chart_of_[next]] += (mesh_.position(t[static_cast<std::size_t>((k + 1) % 3)]) -
                                    mesh_.position(t[static_cast<std::size_t>(k)]))
                                       .norm();
      }
    }
    std::uint32_t best = kInvalidIndex;
    double longest = 0.0;
    for (const auto& [other, length] : border) {
      if (length <= longest || !accepts(charts_[other], faces)) continue;
      best = other;
      longest = length;
    }
    return best;
  }

  bool accepts(const Chart& chart, const std::vector<std::uint32_t>& faces) const {
    if (chart.faces.size() + faces.size() > options_.max_faces + options_.max_faces / 4) return false;
    const double min_cosine = cosine_of(options_.merge_cone_angle);
    return std::all_of(faces.begin(), faces.end(),
                       [&](std::uint32_t f) { return graph_.normal[f].dot(chart.axis) >= min_cosine; });
  }

  // Faces with two edges on one other chart move there: they would leave narrow notches, at whose ends
  // conformal maps overlap. The face is a leaf of its chart, which so stays connected.
  bool smooth_borders() {
    const double min_cosine = cosine_of(options_.merge_cone_angle);
    bool moved = false;
    for (std::uint32_t f = 0; f < graph_.size(); ++f) {
      const auto& around = graph_.neighbour[f];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = around[k];
        const std::uint32_t b = around[(k + 1) % 3];
        if (a == kInvalidIndex || b == kInvalidIndex || chart_of_[a] != chart_of_[b]) continue;
        const std::uint32_t target = chart_of_[a];
        if (target == chart_of_[f] || !(graph_.normal[f].dot(charts_[target].axis) >= min_cosine)) continue;
        chart_of_[f] = target;
        moved = true;
        break;
      }
    }
    return moved;
  }

  // From `chart_of_`, in rising order.
  void collect_faces() {
    for (Chart& chart : charts_) chart.faces.clear();
    for (std::uint32_t f = 0; f < graph_.size(); ++f) charts_[chart_of_[f]].faces.push_back(f);
  }

  void merge(std::uint32_t from, std::uint32_t into) {
    for (const std::uint32_t f : charts_[from].faces) chart_of_[f] = into;
    charts_[into].faces.insert(charts_[into].faces.end(), charts_[from].faces.begin(),
                               charts_[from].faces.end());
    charts_[into].area += charts_[from].area;
    charts_[from].faces.clear();
  }

  const SurfaceMesh& mesh_;
  const FaceGraph& graph_;
  const PatchAtlasOptions& options_;
  std::vector<std::uint32_t> chart_of_;
  std::vector<std::uint32_t> reached_by_;
  std::uint32_t query_ = 0;
  std::vector<std::uint8_t> region_flat_;
  std::vector<double> region_area_;
  std::vector<Chart> charts_;
};

}  // namespace

FaceGraph::FaceGraph(const SurfaceMesh& mesh)
    : normal(mesh.face_count()), area(mesh.face_count()), neighbour(mesh.face_count()) {
  for (std::size_t f = 0; f < normal.size(); ++f) {
    normal[f] = mesh.face_normal(f);
    area[f] = mesh.face_area(f);
    for (int k = 0; k < 3; ++k) {
      const bool smooth = mesh.crease(mesh.edge(f, k)) == 0;
      neighbour[f][static_cast<std::size_t>(k)] = smooth ? mesh.neighbour(f, k) : kInvalidIndex;
    }
  }
}

std::vector<std::vector<std::uint32_t>> grow_charts(const SurfaceMesh& mesh, const FaceGraph& graph,
                                                    const PatchAtlasOptions& options) {
  return ChartGrower(mesh, graph, options).charts();
}

}  // namespace vrc
