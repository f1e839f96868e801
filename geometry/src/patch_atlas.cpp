// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/patch_atlas.h"

#include <algorithm>
#include <utility>

#include "chart_check.h"
#include "chart_flatten.h"
#include "chart_growth.h"
#include "core/error.h"
#include "core/parallel.h"
#include "geometry/curvature.h"
#include "shelf_packer.h"

namespace vrc {
namespace {

std::vector<FlatChart> flatten_all(const SurfaceMesh& mesh, const FaceGraph& graph,
                                   const PatchAtlasOptions& options) {
  const std::vector<std::vector<std::uint32_t>> grown = grow_charts(mesh, graph, options);
  std::vector<std::uint32_t> chart_of(graph.size(), kInvalidIndex);
  for (std::uint32_t c = 0; c < grown.size(); ++c) {
    for (const std::uint32_t f : grown[c]) chart_of[f] = c;
  }
  std::vector<std::uint32_t> local(graph.size());
  std::vector<std::vector<FlatChart>> parts(grown.size());
  parallel_for(grown.size(), [&](std::size_t c) {
    parts[c] = flatten_chart(make_chart_mesh(mesh, graph, grown[c], chart_of, local), options);
  });
  std::vector<FlatChart> charts;
  for (std::vector<FlatChart>& list : parts) {
    for (FlatChart& chart : list) charts.push_back(std::move(chart));
  }
  std::sort(charts.begin(), charts.end(), [](const FlatChart& a, const FlatChart& b) {
    return a.mesh.source.front() < b.mesh.source.front();
  });
  return charts;
}

Patch describe(const FlatChart& chart) {
  Patch patch;
  patch.method = chart.method;
  patch.frame = mean_frame(chart);
  for (std::size_t f = 0; f < chart.mesh.size(); ++f) patch.area += 0.5 * chart.mesh.scaled_normal(f).norm();
  for (const Vec2& p : chart.uv) patch.uv_size = patch.uv_size.cwiseMax(p);
  return patch;
}

AtlasQuality measure(const PatchAtlas& atlas, const FaceGraph& graph) {
  AtlasQuality quality;
  double area = 0.0;
  double stretch_sum = 0.0;
  double distortion_sum = 0.0;
  for (std::size_t f = 0; f < graph.size(); ++f) {
    const Vec2 s = atlas.singular_values(f);
    if (!(s[1] > 0.0)) {
      ++quality.flipped_faces;
      continue;
    }
    const double stretch = s[0] / s[1];
    const double distortion = std::max(s[0] * s[1], 1.0 / (s[0] * s[1]));
    area += graph.area[f];
    stretch_sum += graph.area[f] * stretch;
    distortion_sum += graph.area[f] * distortion;
    quality.max_stretch = std::max(quality.max_stretch, stretch);
    quality.max_area_distortion = std::max(quality.max_area_distortion, distortion);
  }
  if (area > 0.0) {
    quality.mean_stretch = stretch_sum / area;
    quality.mean_area_distortion = distortion_sum / area;
  }
  for (std::size_t p = 0; p < atlas.patch_count(); ++p) {
    const auto method = static_cast<std::size_t>(atlas.patch(p).method);
    ++quality.patches_by_method[method];
    quality.faces_by_method[method] += atlas.faces(p).size();
  }
  return quality;
}

using PatchPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Each pair both ways, sorted.
PatchPairs adjacent_patches(const FaceGraph& graph, const std::vector<std::uint32_t>& patch_of) {
  PatchPairs pairs;
  for (std::size_t f = 0; f < graph.size(); ++f) {
    for (const std::uint32_t n : graph.neighbour[f]) {
      if (n != kInvalidIndex && patch_of[n] != patch_of[f]) pairs.emplace_back(patch_of[f], patch_of[n]);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace

Mat32 PatchAtlas::jacobian(std::size_t face) const {
  const auto [a, b, c] = mesh_->positions(face);
  Mat32 edges;
  edges << b - a, c - a;
  Mat2 uv_edges;
  uv_edges << uv(face, 1) - uv(face, 0), uv(face, 2) - uv(face, 0);
  return edges * uv_edges.inverse();
}

Vec2 PatchAtlas::singular_values(std::size_t face) const {
  return singular_values_of_map(mesh_->positions(face), {uv(face, 0), uv(face, 1), uv(face, 2)});
}

Frame PatchAtlas::frame_at(std::size_t patch, const Vec3& normal) const {
  const Frame& frame = patches_[patch].frame;
  const Vec3 turned = minimal_rotation(frame.normal, normal) * frame.tangent;
  const Vec3 tangent = (turned - normal.dot(turned) * normal).normalized();
  return {tangent, normal.cross(tangent), normal};
}

Mat2 PatchAtlas::transport(std::size_t from, std::size_t to) const {
  // Opposite normals have no smallest rotation: choose one of them for both ways.
  if (from > to) return transport(to, from).transpose();
  const Frame& target = patches_[to].frame;
  const Frame carried = frame_at(from, target.normal);
  const double cosine = target.tangent.dot(carried.tangent);
  const double sine = target.bitangent.dot(carried.tangent);
  return (Mat2() << cosine, -sine, sine, cosine).finished();
}

PatchAtlas build_patch_atlas(const SurfaceMesh& mesh, const PatchAtlasOptions& options) {
  VRC_CHECK(options.cone_angle > 0.0 && options.cone_angle < 90.0, "cone angle {}", options.cone_angle);
  VRC_CHECK(options.merge_cone_angle > 0.0 && options.merge_cone_angle < 90.0, "merge cone angle {}",
            options.merge_cone_angle);
  VRC_CHECK(options.max_stretch >= 1.0, "stretch {}", options.max_stretch);
  VRC_CHECK(options.max_area_distortion >= 1.0, "area distortion {}", options.max_area_distortion);
  const FaceGraph graph(mesh);
  const std::vector<FlatChart> charts = flatten_all(mesh, graph, options);

  PatchAtlas atlas;
  atlas.mesh_ = &mesh;
  atlas.face_patch_.assign(graph.size(), kInvalidIndex);
  atlas.uv_.resize(3 * graph.size());
  atlas.face_begin_.push_back(0);
  for (std::uint32_t p = 0; p < charts.size(); ++p) {
    const FlatChart& chart = charts[p];
    atlas.patches_.push_back(describe(chart));
    atlas.faces_.insert(atlas.faces_.end(), chart.mesh.source.begin(), chart.mesh.source.end());
    atlas.face_begin_.push_back(static_cast<std::uint32_t>(atlas.faces_.size()));
    for (std::size_t f = 0; f < chart.mesh.size(); ++f) {
      const std::size_t face = chart.mesh.source[f];
      atlas.face_patch_[face] = p;
      for (std::size_t k = 0; k < 3; ++k) atlas.uv_[3 * face + k] = chart.uv[chart.mesh.triangles[f][k]];
    }
  }
  atlas.neighbour_begin_.assign(charts.size() + 1, 0);
  for (const auto& [p, neighbour] : adjacent_patches(graph, atlas.face_patch_)) {
    ++atlas.neighbour_begin_[p + 1];
    atlas.neighbours_.push_back(neighbour);
  }
  for (std::size_t p = 0; p < charts.size(); ++p) atlas.neighbour_begin_[p + 1] += atlas.neighbour_begin_[p];

  std::vector<Vec2> sizes;
  for (const Patch& patch : atlas.patches_) sizes.push_back(patch.uv_size);
  const PackedLayout layout = pack_shelves(sizes);
  for (std::size_t p = 0; p < charts.size(); ++p) atlas.patches_[p].layout_offset = layout.offset[p];
  atlas.layout_size_ = layout.size;
  atlas.quality_ = measure(atlas, graph);
  return atlas;
}

}  // namespace vrc
