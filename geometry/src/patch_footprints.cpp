// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/error.h"
#include "geometry/region_index.h"

namespace vrc {
namespace {

// The bits of a 31-bit number, each followed by a zero.
std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | (v << 16)) & 0x0000ffff0000ffffull;
  v = (v | (v << 8)) & 0x00ff00ff00ff00ffull;
  v = (v | (v << 4)) & 0x0f0f0f0f0f0f0f0full;
  v = (v | (v << 2)) & 0x3333333333333333ull;
  return (v | (v << 1)) & 0x5555555555555555ull;
}

std::uint64_t z_curve(const Vec2& unit) {
  constexpr double kCells = 2147483647.0;  // 2^31 - 1
  return spread_bits(static_cast<std::uint64_t>(unit.x() * kCells)) |
         (spread_bits(static_cast<std::uint64_t>(unit.y() * kCells)) << 1);
}

}  // namespace

std::vector<PatchFootprint> patch_footprints(const PatchAtlas& atlas, const SurfaceWalk& walk,
                                             const Vec2& radii, std::uint32_t record) {
  std::vector<PatchFootprint> footprints;
  for (const WalkedFace& walked : walk.faces) {
    const std::array<Vec2, 3>& p = walked.corners;
    const std::array<Vec2, 3> uv{atlas.uv(walked.face, 0), atlas.uv(walked.face, 1),
                                 atlas.uv(walked.face, 2)};
    Mat2 edges;
    edges << p[1] - p[0], p[2] - p[0];
    Mat2 uv_edges;
    uv_edges << uv[1] - uv[0], uv[2] - uv[0];
    // The ellipse's image has the half widths of the rows of (map diag(radii)).
    const Mat2 map = uv_edges * edges.inverse();
    const Vec2 half = (map * radii.asDiagonal()).rowwise().norm();
    const Vec2 center = uv[0] - map * p[0];
    Vec2 low = uv[0].cwiseMin(uv[1]).cwiseMin(uv[2]);
    Vec2 high = uv[0].cwiseMax(uv[1]).cwiseMax(uv[2]);
    // A sliver's map may be noise: its triangle then bounds it alone.
    constexpr double kUsable = 1e-8;
    const double usable = kUsable * (p[1] - p[0]).norm() * (p[2] - p[0]).norm();
    if (std::abs(edges.determinant()) > usable) {
      const Vec2 slack = Vec2::Constant(1e-7 * half.maxCoeff());
      const Vec2 clipped_low = low.cwiseMax(center - half - slack);
      const Vec2 clipped_high = high.cwiseMin(center + half + slack);
      if ((clipped_low.array() > clipped_high.array()).any()) continue;
      low = clipped_low;
      high = clipped_high;
    }
    footprints.push_back({record, atlas.patch_of(walked.face), low, high});
  }
  std::stable_sort(footprints.begin(), footprints.end(),
                   [](const PatchFootprint& a, const PatchFootprint& b) { return a.patch < b.patch; });
  std::size_t count = 0;
  for (const PatchFootprint& f : footprints) {
    if (count > 0 && footprints[count - 1].patch == f.patch) {
      footprints[count - 1].low = footprints[count - 1].low.cwiseMin(f.low);
      footprints[count - 1].high = footprints[count - 1].high.cwiseMax(f.high);
    } else {
      footprints[count++] = f;
    }
  }
  footprints.resize(count);
  return footprints;
}

std::vector<std::uint32_t> spatial_order(std::size_t record_count,
                                         std::span<const PatchFootprint> footprints) {
  std::vector<const PatchFootprint*> first(record_count, nullptr);
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high = -low;
  for (const PatchFootprint& f : footprints) {
    VRC_CHECK(f.record < record_count, "record {} of {}", f.record, record_count);
    if (first[f.record] == nullptr || f.patch < first[f.record]->patch) first[f.record] = &f;
    low = low.cwiseMin(0.5 * (f.low + f.high));
    high = high.cwiseMax(0.5 * (f.low + f.high));
  }
  const double size = std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
  std::vector<std::tuple<std::uint32_t, std::uint64_t, std::uint32_t>> keys;
  for (std::uint32_t r = 0; r < record_count; ++r) {
    if (first[r] == nullptr) {
      keys.emplace_back(kInvalidIndex, 0, r);
    } else {
      const Vec2 center = 0.5 * (first[r]->low + first[r]->high);
      keys.emplace_back(first[r]->patch, z_curve((center - low) / size), r);
    }
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(record_count);
  for (const auto& key : keys) order.push_back(std::get<2>(key));
  return order;
}

}  // namespace vrc
