// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_flatten.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "chart_check.h"
#include "chart_lscm.h"

namespace vrc {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double area_of(const ChartMesh& chart) {
  double sum = 0.0;
  for (std::size_t f = 0; f < chart.size(); ++f) sum += 0.5 * chart.scaled_normal(f).norm();
  return sum;
}

Vec3 mean_normal(const ChartMesh& chart) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t f = 0; f < chart.size(); ++f) sum += chart.scaled_normal(f);
  const double length = sum.norm();
  return length > 0.0 ? Vec3(sum / length) : Vec3(chart.scaled_normal(0).normalized());
}

std::vector<Vec2> orthographic_map(const ChartMesh& chart) {
  const Frame frame = Frame::around(mean_normal(chart));
  std::vector<Vec2> uv;
  uv.reserve(chart.positions.size());
  for (const Vec3& p : chart.positions) {
    const Vec3 d = p - chart.positions.front();
    uv.emplace_back(d.dot(frame.tangent), d.dot(frame.bitangent));
  }
  return uv;
}

// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  std::vector<Vec2> hull;
  const auto add_chain = [&hull](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= base + 2 &&
             cross(hull.back() - hull[hull.size() - 2], *p - hull[hull.size() - 2]) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

// Unit direction of the longer side of the smallest rectangle that holds the points, which has a side
// on the hull. At most about 200 edges of the hull are tried.
Vec2 long_side(const std::vector<Vec2>& points) {
  const std::vector<Vec2> hull = convex_hull(points);
  const std::size_t step = hull.size() / 200 + 1;
  Vec2 best(1.0, 0.0);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); i += step) {
    const Vec2 e = hull[(i + 1) % hull.size()] - hull[i];
    const double length = e.norm();
    if (!(length > 0.0)) continue;
    const Vec2 d = e / length;
    Eigen::AlignedBox2d box;
    for (const Vec2& p : hull) box.extend(Vec2(d.dot(p), cross(d, p)));
    if (!(box.volume() < smallest * (1.0 - 1e-9))) continue;
    smallest = box.volume();
    best = box.sizes().x() >= box.sizes().y() ? d : Vec2(-d.y(), d.x());
  }
  return best;
}

// Scales to the surface's area, turns the long side along u and moves to the origin. False when the
// map has no area.
bool normalise(std::vector<Vec2>& uv, const ChartMesh& chart) {
  double uv_area = 0.0;
  for (const auto& [a, b, c] : chart.triangles) uv_area += 0.5 * cross(uv[b] - uv[a], uv[c] - uv[a]);
  const double scale = std::sqrt(area_of(chart) / uv_area);
  if (!(uv_area > 0.0) || !std::isfinite(scale)) return false;
  const Vec2 u = scale * long_side(uv);
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  for (Vec2& p : uv) {
    p = Vec2(u.dot(p), cross(u, p));
    low = low.cwiseMin(p);
  }
  for (Vec2& p : uv) p -= low;
  return true;
}

struct Attempt {
  std::vector<Vec2> uv;
  ChartCheck check;
};

Attempt checked(std::vector<Vec2> uv, const ChartMesh& chart, const PatchAtlasOptions& options) {
  Attempt attempt{std::move(uv), {}};
  if (normalise(attempt.uv, chart)) {
    attempt.check = check_chart(chart, attempt.uv, options);
  } else {
    attempt.check.bad_faces.resize(chart.size());
    std::iota(attempt.check.bad_faces.begin(), attempt.check.bad_faces.end(), 0u);
  }
  return attempt;
}

FlatChart single_face(ChartMesh chart) {
  const std::array<Vec2, 3> flat = laid_down(chart.corners(0));
  std::vector<Vec2> uv(3);
  for (std::size_t k = 0; k < 3; ++k) uv[chart.triangles[0][k]] = flat[k];
  return {std::move(chart), ChartMethod::kSingleFace, std::move(uv)};
}

// Halves by the centroids along their widest axis.
std::vector<std::uint32_t> halves(const ChartMesh& chart) {
  std::vector<Vec3> centroids;
  Box3 box;
  for (std::size_t f = 0; f < chart.size(); ++f) {
    const auto [a, b, c] = chart.corners(f);
    box.extend(centroids.emplace_back((a + b + c) / 3.0));
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  std::vector<std::uint32_t> order(chart.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return centroids[a][axis] < centroids[b][axis]; });
  std::vector<std::uint32_t> label(chart.size(), 0);
  for (std::size_t i = order.size() / 2; i < order.size(); ++i) label[order[i]] = 1;
  return label;
}

// What `flatten_chart` does with one chart: a map, or the labels to cut it by.
struct Outcome {
  std::optional<FlatChart> flat;
  std::vector<std::uint32_t> cut;
};

Outcome flatten_or_cut(ChartMesh& chart, const PatchAtlasOptions& options, bool may_drop_faces) {
  if (chart.size() == 1) return {single_face(std::move(chart)), {}};
  constexpr double kFlatStretch = 1.0 + 1e-4;
  Attempt projected = checked(orthographic_map(chart), chart, options);
  const double enough = chart.size() > options.direct_faces ? options.direct_stretch : kFlatStretch;
  const bool direct = projected.check.passed() && projected.check.max_stretch <= enough;
  const ChartCheck* fewest = &projected.check;
  Attempt conformal;
  if (!direct && chart.has_boundary()) {
    if (auto uv = conformal_map(chart)) {
      conformal = checked(std::move(*uv), chart, options);
      if (conformal.check.passed()) {
        return {FlatChart{std::move(chart), ChartMethod::kConformal, std::move(conformal.uv)}, {}};
      }
      if (conformal.check.bad_faces.size() < fewest->bad_faces.size()) fewest = &conformal.check;
    }
  }
  if (projected.check.passed()) {
    return {FlatChart{std::move(chart), ChartMethod::kOrthographic, std::move(projected.uv)}, {}};
  }
  const std::size_t bad = fewest->bad_faces.size();
  if (!may_drop_faces || bad == 0 || 8 * bad > chart.size()) return {std::nullopt, halves(chart)};
  std::vector<std::uint32_t> label(chart.size(), 0);
  for (std::uint32_t i = 0; i < bad; ++i) label[fewest->bad_faces[i]] = i + 1;
  return {std::nullopt, std::move(label)};
}

}  // namespace

std::vector<FlatChart> flatten_chart(ChartMesh chart, const PatchAtlasOptions& options) {
  // Dropping bad faces often helps at once; when it has not after a few times, halving surely ends.
  constexpr int kDrops = 3;
  struct Waiting {
    ChartMesh chart;
    int drops = 0;
  };
  std::vector<Waiting> waiting;
  waiting.push_back({std::move(chart)});
  std::vector<FlatChart> done;
  while (!waiting.empty()) {
    Waiting next = std::move(waiting.back());
    waiting.pop_back();
    Outcome outcome = flatten_or_cut(next.chart, options, next.drops < kDrops);
    if (outcome.flat) {
      done.push_back(std::move(*outcome.flat));
      continue;
    }
    for (ChartMesh& part : cut_chart(next.chart, outcome.cut)) {
      waiting.push_back({std::move(part), next.drops + 1});
    }
  }
  return done;
}

Frame mean_frame(const FlatChart& chart) {
  // The sum over the faces of (area in uv) dx/du needs no division.
  Vec3 sum = Vec3::Zero();
  for (std::size_t f = 0; f < chart.mesh.size(); ++f) {
    const auto [a, b, c] = chart.mesh.corners(f);
    const Triangle& t = chart.mesh.triangles[f];
    const Vec2 d1 = chart.uv[t[1]] - chart.uv[t[0]];
    const Vec2 d2 = chart.uv[t[2]] - chart.uv[t[0]];
    sum += d2.y() * (b - a) - d1.y() * (c - a);
  }
  const Vec3 normal = mean_normal(chart.mesh);
  const Vec3 tangent = sum - normal.dot(sum) * normal;
  if (!(tangent.norm() > 1e-9 * sum.norm())) return Frame::around(normal);
  const Vec3 unit = tangent.normalized();
  return {unit, normal.cross(unit), normal};
}

}  // namespace vrc
