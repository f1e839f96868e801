// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
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

// What a face holds of a walked ellipse.
struct FacePart {
  PatchFootprint footprint;
  std::array<Vec2, 3> uv;  // Of the face's corners.
  Eigen::Matrix<double, 2, 2, Eigen::DontAlign> map =
      Mat2::Zero();     // Takes the unit disk to the ellipse around footprint.center in (u, v).
  bool usable = false;  // Whether the map is more than noise, as that of a sliver is.
};

std::optional<FacePart> face_part(const PatchAtlas& atlas, const WalkedFace& walked, const Vec2& radii,
                                  std::uint32_t record) {
  const std::array<Vec2, 3>& p = walked.corners;
  FacePart part;
  for (int k = 0; k < 3; ++k) part.uv[static_cast<std::size_t>(k)] = atlas.uv(walked.face, k);
  const std::array<Vec2, 3>& uv = part.uv;
  Mat2 edges;
  edges << p[1] - p[0], p[2] - p[0];
  Mat2 uv_edges;
  uv_edges << uv[1] - uv[0], uv[2] - uv[0];
  Vec2 low = uv[0].cwiseMin(uv[1]).cwiseMin(uv[2]);
  Vec2 high = uv[0].cwiseMax(uv[1]).cwiseMax(uv[2]);
  constexpr double kUsable = 1e-8;
  part.usable = std::abs(edges.determinant()) > kUsable * (p[1] - p[0]).norm() * (p[2] - p[0]).norm();
  part.footprint = {record, atlas.patch_of(walked.face), low, high};
  if (!part.usable) return part;  // The triangle bounds it alone.
  const Mat2 map = uv_edges * edges.inverse();
  const Vec2 center = uv[0] - map * p[0];
  part.map = map * radii.asDiagonal();
  // The ellipse's image has the half widths of the rows of its map.
  const Vec2 half = part.map.rowwise().norm();
  const Vec2 slack = Vec2::Constant(1e-7 * half.maxCoeff());
  low = low.cwiseMax(center - half - slack);
  high = high.cwiseMin(center + half + slack);
  if ((low.array() > high.array()).any()) return std::nullopt;
  part.footprint = {record, part.footprint.patch, low, high, center, part.map.inverse()};
  return part;
}

// How large the part is, seen in the ellipse of a footprint: 1 if it just fits in.
double reach_in(const PatchFootprint& ellipse, const FacePart& part) {
  double corners = 0.0;
  for (const Vec2& uv : part.uv) corners = std::max(corners, (ellipse.shape * (uv - ellipse.center)).norm());
  if (!part.usable) return corners;
  const Mat2 relative = ellipse.shape * part.map;
  // The larger singular value.
  const double size = 0.5 * (std::hypot(relative(0, 0) + relative(1, 1), relative(1, 0) - relative(0, 1)) +
                             std::hypot(relative(0, 0) - relative(1, 1), relative(1, 0) + relative(0, 1)));
  return std::min(corners, size + (ellipse.shape * (part.footprint.center - ellipse.center)).norm());
}

// Of parts in one patch. A first face without a usable map leaves the box alone.
PatchFootprint join(std::span<const FacePart> parts) {
  PatchFootprint joined = parts.front().footprint;
  double reach = 1.0;
  for (const FacePart& part : parts) {
    joined.low = joined.low.cwiseMin(part.footprint.low);
    joined.high = joined.high.cwiseMax(part.footprint.high);
    reach = std::max(reach, reach_in(joined, part));
  }
  constexpr double kRounding = 1e-7;
  joined.shape /= reach * (1.0 + kRounding);
  return joined;
}

}  // namespace

std::vector<PatchFootprint> patch_footprints(const PatchAtlas& atlas, const SurfaceWalk& walk,
                                             const Vec2& radii, std::uint32_t record) {
  std::vector<FacePart> parts;
  for (const WalkedFace& walked : walk.faces) {
    if (const std::optional<FacePart> part = face_part(atlas, walked, radii, record)) parts.push_back(*part);
  }
  std::stable_sort(parts.begin(), parts.end(), [](const FacePart& a, const FacePart& b) {
    return a.footprint.patch < b.footprint.patch;
  });
  std::vector<PatchFootprint> footprints;
  for (std::size_t begin = 0; begin < parts.size();) {
    std::size_t end = begin + 1;
    while (end < parts.size() && parts[end].footprint.patch == parts[begin].footprint.patch) ++end;
    footprints.push_back(join(std::span(parts).subspan(begin, end - begin)));
    begin = end;
  }
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
