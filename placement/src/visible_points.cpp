// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/visible_points.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <span>

#include "core/hash.h"
#include "core/parallel.h"
#include "core/sobol.h"

namespace vrc {
namespace {

constexpr int kPilotStride = 32;  // pixels between the first records
constexpr double kFilmPointsPerPixel = 0.5;

/// Calls body(i) for i in [0, count), short work each, from several threads.
template <typename Body>
void for_each_index(std::size_t count, const Body& body) {
  constexpr std::size_t kAtOnce = 4096;
  parallel_for((count + kAtOnce - 1) / kAtOnce, [&](std::size_t k) {
    for (std::size_t i = k * kAtOnce; i < std::min((k + 1) * kAtOnce, count); ++i) body(i);
  });
}

/// The pixels of a window in ever finer square lattices, as numbers along its rows: those of a square of
/// 2^levels pixels in the order of their Morton codes with the bits reversed.
std::vector<std::uint32_t> coarse_to_fine(int width, int height) {
  const int levels = std::bit_width(static_cast<unsigned>(std::max(width, height) - 1));
  std::vector<std::uint32_t> order(std::size_t{1} << (2 * levels));
  for_each_index(order.size(), [&](std::size_t code) {
    int x = 0, y = 0;
    for (int bit = 0; bit < levels; ++bit) {
      const auto digit = static_cast<int>(code >> (2 * (levels - 1 - bit))) & 3;
      y |= (digit & 1) << bit;
      x |= ((digit >> 1) ^ (digit & 1)) << bit;
    }
    order[code] = x < width && y < height ? static_cast<std::uint32_t>(y * width + x) : kInvalidIndex;
  });
  std::erase(order, kInvalidIndex);
  return order;
}

/// Distance between the pilot records: small pictures get some as well.
int pilot_stride(const PlacementView& view) {
  int stride = kPilotStride;
  while (stride > 1 && 8 * stride > std::min(view.x1 - view.x0, view.y1 - view.y0)) stride /= 2;
  return stride;
}

struct FilmPosition {
  float x, y;
  std::uint64_t key;
  std::uint32_t turn;
};

}  // namespace

/// Looks through positions of the film.
class VisiblePoints::Collector {
 public:
  /// position_at(i) for i in [0, count) are the positions as the points are to be ordered; the first are
  /// those of pilot records.
  template <typename PositionAt>
  static VisiblePoints collect(const SceneCharts& charts, std::size_t count, const PositionAt& position_at,
                               std::size_t pilot_positions, std::uint64_t& camera_rays) {
    std::vector<Point> points(count);
    parallel_for((count + kLanes - 1) / kLanes,
                 [&](std::size_t packet) { look(charts.scene(), position_at, packet * kLanes, points); });
    camera_rays += count;
    const auto is_seen = [](const Point& p) { return p.region >= 0; };
    const auto pilots = std::ranges::count_if(std::span(points).first(pilot_positions), is_seen);
    std::erase_if(points, std::not_fn(is_seen));
    return {charts, std::move(points), static_cast<std::size_t>(pilots)};
  }

 private:
  template <typename PositionAt>
  static void look(const Scene& scene, const PositionAt& position_at, std::size_t first,
                   std::vector<Point>& points) {
    const auto count = static_cast<int>(std::min<std::size_t>(kLanes, points.size() - first));
    std::array<FilmPosition, kLanes> positions{};
    F16 x{}, y{};
    for (int i = 0; i < count; ++i) {
      const FilmPosition& position = positions[static_cast<std::size_t>(i)] =
          position_at(first + static_cast<std::size_t>(i));
      x[i] = position.x;
      y[i] = position.y;
    }
    const Camera& camera = scene.camera();
    const Ray16 ray = {splat3(camera.origin), camera_directions(camera, x, y), splat(1e17f)};
    const SurfacePoint16 p = scene.intersect(lane_index() < count, ray, RayTracer::Coherence::kIncoherent);
    for (int i = 0; i < count; ++i) {
      if (p.scatters[i] == 0) continue;
      Point& point = points[first + static_cast<std::size_t>(i)];
      point.position = {p.position.x[i], p.position.y[i], p.position.z[i]};
      point.normal = {p.normal.x[i], p.normal.y[i], p.normal.z[i]};
      point.triangle = static_cast<std::uint32_t>(p.triangle[i]);
      point.u = p.u[i];
      point.v = p.v[i];
      point.region = p.region[i];
      point.key = positions[static_cast<std::size_t>(i)].key;
      point.turn = positions[static_cast<std::size_t>(i)].turn;
    }
  }
};

namespace {

template <typename Points>
std::vector<ChartPoint> in_charts(const SceneCharts& charts, const Points& points) {
  std::vector<ChartPoint> result(points.size());
  for_each_index(points.size(), [&](std::size_t i) {
    const auto& p = points[i];
    result[i] = {charts.patch_of(p.triangle),
                 charts.uv(p.triangle, static_cast<double>(p.u), static_cast<double>(p.v))};
  });
  return result;
}

}  // namespace

VisiblePoints::VisiblePoints(const SceneCharts& charts, std::vector<Point> points, std::size_t pilot_count)
    : charts_(&charts),
      points_(std::move(points)),
      covered_(points_.size(), 0),
      pilot_count_(pilot_count),
      grid_(charts.patch_count(), in_charts(charts, points_)) {}

SurfacePoint VisiblePoints::surface_point(std::size_t i) const {
  const Scene& scene = charts_->scene();
  const Point& p = points_[i];
  return scene.surface_point(p.triangle, p.u, p.v, scene.camera().origin);
}

void VisiblePoints::cover(const ValidRegion& region, const SurfaceReach& reach, std::uint32_t turn) {
  for_each_within(region, reach, 1.0, [&](std::uint32_t i, float, float, float) {
    if (points_[i].turn >= turn) covered_[i] = 1;
  });
}

void VisiblePoints::clear_coverage() { std::ranges::fill(covered_, std::uint8_t{0}); }

VisiblePoints pixel_centres(const SceneCharts& charts, const PlacementView& view,
                            std::uint64_t& camera_rays) {
  const int width = view.x1 - view.x0, height = view.y1 - view.y0;
  const std::vector<std::uint32_t> order = coarse_to_fine(width, height);
  const auto position_at = [&](std::size_t i) {
    const auto pixel = static_cast<int>(order[i]);
    const int x = view.x0 + pixel % width, y = view.y0 + pixel / width;
    // The key depends on the film's coordinates only, not on the window.
    return FilmPosition{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, hash(0x9121u, x, y),
                        turn_of(x, y)};
  };
  const int stride = pilot_stride(view);
  const auto along = [&](int extent) { return static_cast<std::size_t>((extent + stride - 1) / stride); };
  return VisiblePoints::Collector::collect(charts, order.size(), position_at, along(width) * along(height),
                                           camera_rays);
}

VisiblePoints film_points(const SceneCharts& charts, const PlacementView& view, std::uint64_t& camera_rays) {
  const auto width = static_cast<double>(view.x1 - view.x0), height = static_cast<double>(view.y1 - view.y0);
  const auto count = static_cast<std::size_t>(std::ceil(kFilmPointsPerPixel * width * height));
  const auto position_at = [&](std::size_t index) {
    const auto i = static_cast<std::uint32_t>(index);
    const auto coordinate = [&](int dimension, double size) {
      const std::uint32_t bits = owen_scramble(sobol(i, dimension), 0x51f15eedu + dimension);
      return static_cast<float>((static_cast<double>(bits) + 0.5) * 0x1p-32 * size);
    };
    return FilmPosition{static_cast<float>(view.x0) + coordinate(0, width),
                        static_cast<float>(view.y0) + coordinate(1, height), hash(0xf117u, i), 0};
  };
  const double stride = pilot_stride(view);
  const auto pilots = static_cast<std::size_t>(std::ceil(width * height / (stride * stride)));
  return VisiblePoints::Collector::collect(charts, count, position_at, std::min(pilots, count), camera_rays);
}

}  // namespace vrc
