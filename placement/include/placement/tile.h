// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <vector>

#include "placement/radiance_cache.h"
#include "transport/film_sampler.h"

namespace vrc {

inline constexpr int kTileSize = 16;

/// A run of packets of every pixel, so that memory does not grow with the samples per pixel.
struct PacketRange {
  int first = 0;
  int count = 1;
};
inline constexpr int kPacketsAtOnce = 4;

struct Pixel {
  int x = 0, y = 0;
};

/// The camera samples of pixels that lie together: packet k of the range of pixel p is entry
/// p * packets_per_pixel + k.
struct Tile {
  std::vector<Pixel> pixels;
  int packets_per_pixel = 1;  ///< In this tile: the length of its range.
  std::vector<CameraPacket> packets;
  std::vector<SurfacePoint16> points;  ///< Parallel to `packets`.

  [[nodiscard]] std::uint32_t turn(std::size_t packet) const {
    const Pixel& p = pixels[packet / static_cast<std::size_t>(packets_per_pixel)];
    return turn_of(p.x, p.y);
  }
};

/// Tiles of a pixel rectangle, in rows from the top; the last of a row or column may be smaller.
struct TileLayout {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] int columns() const { return (x1 - x0 + kTileSize - 1) / kTileSize; }
  [[nodiscard]] int rows() const { return (y1 - y0 + kTileSize - 1) / kTileSize; }
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(columns()) * static_cast<std::size_t>(rows());
  }
};

/// Those of tile `index`, row by row.
[[nodiscard]] std::vector<Pixel> pixels_of(const TileLayout& layout, std::size_t index);
/// Traces the camera rays of pixels.
[[nodiscard]] Tile trace_tile(const Scene& scene, const FilmSampler& film, std::vector<Pixel> pixels,
                              const PacketRange& range, RayCounts& counts);
/// Calls body(range) for runs of at most kPacketsAtOnce packets that make up all of a pixel's.
template <typename Body>
void for_each_range(const FilmSampler& film, const Body& body) {
  for (int first = 0; first < film.packets_per_pixel(); first += kPacketsAtOnce) {
    body(PacketRange{first, std::min(kPacketsAtOnce, film.packets_per_pixel() - first)});
  }
}

/// Whether the samples of pixel `pixel` of a tile see different smooth regions of surfaces, or one that turns
/// by more than kEdgeTurn, or miss some.
[[nodiscard]] bool sees_edge(const Tile& tile, std::size_t pixel);
inline constexpr float kCosEdgeTurn = 0.9f;

inline constexpr int kMostEdgeSamples = 128;
/// Camera samples that pixels with edges get beyond the others' `samples`: eight times as many in all, but
/// not more than kMostEdgeSamples in all.
[[nodiscard]] inline int further_edge_samples(int samples) {
  return std::max(0, std::min(8 * samples, kMostEdgeSamples) - samples);
}
/// Calls body(tile) for the packets of all pixels of a tile, then for those of `further` samples more of the
/// pixels that see an edge. Returns which do.
template <typename Body>
std::vector<Pixel> for_each_traced(const Scene& scene, const FilmSampler& film, std::vector<Pixel> pixels,
                                   int further, RayCounts& counts, const Body& body) {
  std::vector<Pixel> edges;
  for_each_range(film, [&](const PacketRange& range) {
    const Tile tile = trace_tile(scene, film, pixels, range, counts);
    if (range.first == 0) {
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (sees_edge(tile, i)) edges.push_back(pixels[i]);
      }
    }
    body(tile);
  });
  if (!edges.empty() && further > 0) {
    const FilmSampler finer = film.further(further);
    for_each_range(finer,
                   [&](const PacketRange& range) { body(trace_tile(scene, finer, edges, range, counts)); });
  }
  return edges;
}

/// Finds the records that reach the points of a tile. Cache and tile must outlive it.
class TileRecords {
 public:
  TileRecords(const RadianceCache& cache, const Tile& tile);

  [[nodiscard]] const RadianceCache& cache() const { return cache_; }
  [[nodiscard]] const Tile& tile() const { return tile_; }

  /// Calls body(record, coverage) for the records that reach a point of packet `packet` of the tile
  /// over its surface, whose region, widened `support` times, holds it, and whose turn has come.
  template <typename Body>
  void for_each(std::size_t packet, float support, Deviation deviation, const Body& body) const {
    for_each_while(packet, support, deviation, [&](const PackedRecord& record, const Coverage16& c) {
      body(record, c);
      return true;
    });
  }
  /// As long as body(record, coverage) says so.
  template <typename Body>
  void for_each_while(std::size_t packet, float support, Deviation deviation, const Body& body) const {
    const SurfacePoint16& p = tile_.points[packet];
    const std::uint32_t turn = tile_.turn(packet);
    const Sphere around = bounds(p);
    for (std::size_t first = 0; first < spheres_.size(); ++first) {
      for (std::uint32_t left = spheres_[first].near(around, support); left != 0; left &= left - 1) {
        const std::size_t i = first * kLanes + static_cast<std::size_t>(std::countr_zero(left));
        const RadianceCache::Footprint& f = cache_.footprints()[candidates_[i]];
        const PackedRecord& record = cache_.packed()[f.record];
        if (record.turn > turn || !may_reach(record, p, support)) continue;
        const I16 reached = cache_.reaches(f, at_[packet], p.triangle);
        if (!any(reached)) continue;
        const Coverage16 c = coverage(record, p.position, p.normal, reached, support, deviation);
        if (any(c.weight > 0.0f) && !body(record, c)) return;
      }
    }
  }

 private:
  struct Sphere {
    Vec3f center;
    float radius;
  };
  /// What sixteen records reach at most.
  struct Spheres16 {
    V3x16 center{};
    F16 radius{};  ///< With support 1; negative: no record.

    /// A bit for each that may meet a sphere.
    [[nodiscard]] std::uint32_t near(const Sphere& sphere, float support) const {
      const V3x16 d = center - splat3(sphere.center);
      const F16 reach = (radius * support + sphere.radius) * kRoundingSlack;
      return mask_bits((dot(d, d) <= reach * reach) & (radius >= 0.0f));
    }
  };
  static constexpr float kRoundingSlack = 1.0001f;

  /// Around the points of a packet that scatter.
  [[nodiscard]] static Sphere bounds(const SurfacePoint16& p);
  [[nodiscard]] static float reach_of(const PackedRecord& record);
  [[nodiscard]] static bool may_reach(const PackedRecord& record, const SurfacePoint16& p, float support);

  const RadianceCache& cache_;
  const Tile& tile_;
  std::vector<ChartPoint16> at_;           ///< Of the tile's packets.
  std::vector<std::uint32_t> candidates_;  ///< Footprints.
  std::vector<Spheres16> spheres_;         ///< Of the candidates' records.
};

}  // namespace vrc
