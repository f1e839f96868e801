// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/irradiance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/hash.h"
#include "gather_rays.h"
#include "hemisphere_edges.h"
#include "sh/basis.h"

namespace vrc {
namespace {

using Rgb64 = Eigen::Array3d;

/// What the ray through a cell of the hemisphere found.
struct Cell {
  Vec3 direction = Vec3::UnitZ();  ///< In the site's frame.
  Rgb64 radiance = Rgb64::Zero();
  double distance = 0.0;  ///< Infinite without a hit.
};

/// Point of the unit disc for the unit square, keeping cells in shape [ShirleyChiu1997].
Vec2 concentric(double u, double v) {
  const double a = 2.0 * u - 1.0, b = 2.0 * v - 1.0;
  if (a == 0.0 && b == 0.0) return Vec2::Zero();
  if (std::abs(a) > std::abs(b)) {
    const double phi = 0.25 * kPi * b / a;
    return a * Vec2(std::cos(phi), std::sin(phi));
  }
  const double phi = 0.5 * kPi - 0.25 * kPi * a / b;
  return b * Vec2(std::cos(phi), std::sin(phi));
}

Vec2 polar(double radius_squared, double turn) {
  const double phi = 2.0 * kPi * turn;
  return std::sqrt(radius_squared) * Vec2(std::cos(phi), std::sin(phi));
}

/// A grid of cells: rows of a multiple of sixteen columns.
struct CellGrid {
  int rows = 0, columns = 0;
  std::vector<Cell> cells;

  [[nodiscard]] const Cell& at(int row, int column) const {
    return cells[static_cast<std::size_t>(row * columns + column)];
  }
};

/// Traces one ray in each cell; `to_disc` maps the unit square to the disc below the hemisphere, keeping
/// ratios of areas, so that directions are cosine-distributed.
template <typename ToDisc>
CellGrid trace_cells(GatherRays& rays, const Frame& frame, int rows, int columns, std::uint32_t seed,
                     const ToDisc& to_disc) {
  CellGrid grid = {rows, columns, std::vector<Cell>(static_cast<std::size_t>(rows * columns))};
  for (std::uint32_t first = 0; first < grid.cells.size(); first += kLanes) {
    const Sample4 u = padded_sobol(std::bit_cast<U16>(lane_index()) + first, splat(seed));
    Cell* cells = &grid.cells[first];
    GatherPacket16 packet;
    F16 density;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int index = static_cast<int>(first) + lane;
      const double row = index / columns + static_cast<double>(u.u[0][lane]);
      const double column = index % columns + static_cast<double>(u.u[1][lane]);
      const Vec2 p = to_disc(row / rows, column / columns);
      const Vec3 d(p[0], p[1], std::sqrt(std::max(1e-12, 1.0 - p.squaredNorm())));
      cells[lane].direction = d;
      const Vec3 world = d[0] * frame.tangent + d[1] * frame.bitangent + d[2] * frame.normal;
      packet.direction.x[lane] = static_cast<float>(world[0]);
      packet.direction.y[lane] = static_cast<float>(world[1]);
      packet.direction.z[lane] = static_cast<float>(world[2]);
      density[lane] = static_cast<float>(d[2] / kPi);
    }
    const bool lit = rays.trace(density, u.u[2], u.u[3], first, packet);
    for (int lane = 0; lane < kLanes; ++lane) {
      cells[lane].distance = static_cast<double>(packet.distance[lane]);
      const V3x16& l = packet.incident.value;
      if (lit) cells[lane].radiance = Rgb64(l.x[lane], l.y[lane], l.z[lane]);
    }
  }
  return grid;
}

/// Mean over the cells, and the turn of the normal.
void set_value_and_rotation(const CellGrid& grid, const Frame& frame, IrradianceEstimate& result) {
  Rgb64 sum = Rgb64::Zero(), along1 = sum, along2 = sum;
  for (const Cell& cell : grid.cells) {
    sum += cell.radiance;
    along1 += cell.direction[0] / cell.direction[2] * cell.radiance;
    along2 += cell.direction[1] / cell.direction[2] * cell.radiance;
  }
  const double share = kPi / static_cast<double>(grid.cells.size());
  for (std::size_t c = 0; c < 3; ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    result.irradiance[c].value = share * sum[i];
    result.rotation[c] = share * (along1[i] * frame.tangent + along2[i] * frame.bitangent);
  }
}

/// The translational gradient of [WardHeckbert1992]: rows are elevations from the pole, columns
/// azimuths; the light behind a cell's wall moves at the speed of the nearer side.
void set_strata_gradient(const CellGrid& grid, IrradianceEstimate& result) {
  const int m = grid.rows, n = grid.columns;
  Eigen::Matrix<double, 2, 3> gradient = Eigen::Matrix<double, 2, 3>::Zero();
  const auto wall = [&](const Cell& cell, const Cell& before, double length, const Vec2& outward) {
    const double nearest = std::min(cell.distance, before.distance);
    if (!std::isfinite(nearest)) return;
    gradient += length / nearest * outward * (cell.radiance - before.radiance).matrix().transpose();
  };
  for (int k = 0; k < n; ++k) {
    const Vec2 middle = polar(1.0, (k + 0.5) / n), begin = polar(1.0, static_cast<double>(k) / n);
    const Vec2 across(-begin[1], begin[0]);
    for (int j = 0; j < m; ++j) {
      const double sine = std::sqrt(static_cast<double>(j) / m);
      const double further = std::sqrt((j + 1.0) / m);
      if (j > 0) wall(grid.at(j, k), grid.at(j - 1, k), 2.0 * kPi / n * sine * (1.0 - sine * sine), middle);
      wall(grid.at(j, k), grid.at(j, (k + n - 1) % n), further - sine, across);
    }
  }
  for (std::size_t c = 0; c < 3; ++c) result.irradiance[c].gradient = gradient.col(static_cast<int>(c));
}

/// The derivatives of [Schwarzhaupt2012] over the edges of the triangles between hits.
void set_triangle_derivatives(const CellGrid& grid, double far, IrradianceEstimate& result) {
  std::vector<Vec3> points;
  std::vector<double> distances;
  for (const Cell& cell : grid.cells) {
    distances.push_back(std::min(cell.distance, far));
    points.push_back(distances.back() * cell.direction);
  }
  const auto index = [&](int row, int column) {
    return static_cast<std::size_t>(row * grid.columns + column);
  };
  const auto farthest = [&](std::size_t a, std::size_t b, std::size_t c) -> const Rgb64& {
    const std::size_t ab = distances[a] >= distances[b] ? a : b;
    return grid.cells[distances[ab] >= distances[c] ? ab : c].radiance;
  };
  // Squares are split along the diagonal from (row, column) to (row + 1, column + 1).
  const auto first = [&](int r, int c) {
    return farthest(index(r, c), index(r + 1, c), index(r + 1, c + 1));
  };
  const auto second = [&](int r, int c) {
    return farthest(index(r, c), index(r + 1, c + 1), index(r, c + 1));
  };
  std::array<Jet2, 3>& sum = result.irradiance;
  const auto add_edge = [&](std::size_t from, std::size_t to, const Rgb64& left, const Rgb64& right) {
    const Rgb64 step = left - right;
    if ((step == 0.0).all()) return;
    const EdgeDerivatives edge = edge_derivatives(points[from], points[to]);
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c].gradient += kPi * step[static_cast<Eigen::Index>(c)] * edge.gradient;
      sum[c].hessian += kPi * step[static_cast<Eigen::Index>(c)] * edge.hessian;
    }
  };
  // Each edge once, between the triangles on its left and on its right; beyond the grid it is dark. Its
  // border is next to the horizon, where edges hardly count, but they complete the outlines of triangles.
  const Rgb64 dark = Rgb64::Zero();
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      const bool more_rows = r + 1 < grid.rows, more_columns = c + 1 < grid.columns;
      if (more_rows && more_columns) add_edge(index(r, c), index(r + 1, c + 1), second(r, c), first(r, c));
      if (more_rows) {
        add_edge(index(r, c), index(r + 1, c), more_columns ? first(r, c) : dark,
                 c > 0 ? second(r, c - 1) : dark);
      }
      if (more_columns) {
        add_edge(index(r, c), index(r, c + 1), r > 0 ? first(r - 1, c) : dark,
                 more_rows ? second(r, c) : dark);
      }
    }
  }
}

}  // namespace

IrradianceEstimate gather_irradiance(const Scene& scene, const RecordSite& site, const GatherOptions& options,
                                     IrradianceDerivatives kind, RayCounts& counts) {
  GatherRays rays(scene, site, options, counts);
  const auto seed = static_cast<std::uint32_t>(hash(options.seed, site.key, 0x1ccu));
  const double count = std::ldexp(1.0, options.log2_rays);
  const auto sixteens = [](double columns) {
    return kLanes * std::max(1, static_cast<int>(std::lround(columns / kLanes)));
  };
  IrradianceEstimate result;
  if (kind == IrradianceDerivatives::kStrata) {
    const int columns = sixteens(std::sqrt(kPi * count));
    const int rows = std::max(1, static_cast<int>(std::lround(count / columns)));
    const CellGrid grid = trace_cells(rays, site.frame, rows, columns, seed, polar);
    set_value_and_rotation(grid, site.frame, result);
    set_strata_gradient(grid, result);
  } else {
    const int columns = sixteens(std::sqrt(count));
    const int rows = std::max(2, static_cast<int>(std::lround(count / columns)));
    const CellGrid grid = trace_cells(rays, site.frame, rows, columns, seed, concentric);
    set_value_and_rotation(grid, site.frame, result);
    set_triangle_derivatives(grid, 100.0 * scene.radius(), result);
  }
  rays.describe_hits(result.hits);
  return result;
}

IncidentHarmonics as_harmonics(const IrradianceEstimate& estimate, const Vec3& normal) {
  // A Lambert lobe weighs them by Y_00 and, with y = sqrt(3 / 4 pi) (n_y, n_z, n_x), by 2/3 y.
  constexpr int kEntries = IncidentHarmonics::kEntries;
  const double constant = 1.0 / (kPi * std::sqrt(0.25 / kPi));
  const double linear = 1.0 / (kPi * 2.0 / 3.0 * std::sqrt(0.75 / kPi));
  IncidentHarmonics::Coefficients result(3 * kEntries, sh::coefficient_count(1));
  for (int c = 0; c < 3; ++c) {
    const Jet2& e = estimate.irradiance[static_cast<std::size_t>(c)];
    const Vec3& g = estimate.rotation[static_cast<std::size_t>(c)];
    Eigen::Matrix<double, kEntries, 4> columns = Eigen::Matrix<double, kEntries, 4>::Zero();
    columns.col(0) << e.value - g.dot(normal), e.gradient[0], e.gradient[1], e.hessian(0, 0), e.hessian(0, 1),
        e.hessian(1, 1);
    columns.col(0) *= constant;
    columns.row(0).tail<3>() = linear * Vec3(g.y(), g.z(), g.x()).transpose();
    result.middleRows<kEntries>(kEntries * c) = columns.cast<float>();
  }
  return IncidentHarmonics(result);
}

}  // namespace vrc
