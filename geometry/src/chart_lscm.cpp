// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_lscm.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "chart_check.h"

namespace vrc {
namespace {

using Complex = std::complex<double>;
using Matrix = Eigen::SparseMatrix<Complex>;
using Vector = Eigen::VectorXcd;

// The two border vertices that are furthest apart along the longest side of the border's box.
std::optional<std::pair<std::uint32_t, std::uint32_t>> pinned_vertices(const ChartMesh& chart) {
  std::vector<std::uint32_t> border;
  Box3 box;
  for (std::size_t f = 0; f < chart.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (chart.neighbours[f][k] != kInvalidIndex) continue;
      border.push_back(chart.triangles[f][k]);
      box.extend(chart.positions[border.back()]);
    }
  }
  if (border.empty()) return std::nullopt;
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto [low, high] = std::minmax_element(
      border.begin(), border.end(),
      [&](std::uint32_t a, std::uint32_t b) { return chart.positions[a][axis] < chart.positions[b][axis]; });
  if (!(chart.positions[*low][axis] < chart.positions[*high][axis])) return std::nullopt;
  return std::pair(*low, *high);
}

// With the corners z of a face laid down in the complex plane, its map to U is conformal where
// (z3 - z2) U1 + (z1 - z3) U2 + (z2 - z1) U3 = 0 [Levy2002, section 2.3]. The factors, scaled so that
// the sum's square is the face's part of the conformal energy.
std::array<Complex, 3> conformal_row(const ChartMesh& chart, std::size_t face) {
  const std::array<Vec2, 3> z = laid_down(chart.corners(face));
  const Vec2 e = z[1] - z[0];
  const Vec2 d = z[2] - z[0];
  constexpr double kThinnest = 1e-9;  // Bounds the weight of slivers.
  const double longest2 = std::max({e.squaredNorm(), d.squaredNorm(), (d - e).squaredNorm()});
  const double scale = 1.0 / std::sqrt(std::max(e.x() * d.y() - e.y() * d.x(), kThinnest * longest2));
  std::array<Complex, 3> row;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 w = scale * (z[(k + 2) % 3] - z[(k + 1) % 3]);
    row[k] = Complex(w.x(), w.y());
  }
  return row;
}

}  // namespace

std::optional<std::vector<Vec2>> conformal_map(const ChartMesh& chart) {
  const auto pinned = pinned_vertices(chart);
  if (!pinned) return std::nullopt;
  const auto [first, second] = *pinned;
  const std::size_t count = chart.positions.size();
  std::vector<Complex> map(count, Complex(0.0, 0.0));
  map[second] = (chart.positions[second] - chart.positions[first]).norm();
  if (count == 2) return std::nullopt;

  // The free vertices in their order; the energy's normal equations, the pinned on the right side.
  std::vector<int> unknown(count, -1);
  int unknowns = 0;
  for (std::uint32_t v = 0; v < count; ++v) {
    if (v != first && v != second) unknown[v] = unknowns++;
  }
  std::vector<Eigen::Triplet<Complex>> entries;
  entries.reserve(6 * chart.size());
  Vector right = Vector::Zero(unknowns);
  for (std::size_t f = 0; f < chart.size(); ++f) {
    const std::array<Complex, 3> row = conformal_row(chart, f);
    const Triangle& t = chart.triangles[f];
    for (std::size_t i = 0; i < 3; ++i) {
      const int r = unknown[t[i]];
      if (r < 0) continue;
      for (std::size_t j = 0; j < 3; ++j) {
        const int c = unknown[t[j]];
        const Complex product = std::conj(row[i]) * row[j];
        if (c < 0) {
          right[r] -= product * map[t[j]];
        } else if (c <= r) {
          entries.emplace_back(r, c, product);
        }
      }
    }
  }
  Matrix energy(unknowns, unknowns);
  energy.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Matrix, Eigen::Lower> solver(energy);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Vector solution = solver.solve(right);
  std::vector<Vec2> result(count);
  for (std::size_t v = 0; v < count; ++v) {
    const Complex u = unknown[v] < 0 ? map[v] : solution[unknown[v]];
    result[v] = Vec2(u.real(), u.imag());
  }
  return result;
}

}  // namespace vrc
