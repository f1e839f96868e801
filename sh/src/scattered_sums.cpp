// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/scattered_sums.h"

#include <algorithm>
#include <cmath>

#include "sh/basis.h"

namespace vrc::sh {
namespace {

using Values = ScatteredSums::Values;

constexpr double kRowsPerOrder = 2.5;  // 1 would be the sampling theorem's
constexpr int kFewestRows = 8;
constexpr int kSupport = 4;                       // cells of a cubic B-spline
constexpr int kRowMargin = 2, kColumnMargin = 1;  // before the first cell; as much or more after the last

/// Within 1e-5 [AbramowitzStegun1964, 4.4.49].
F16 atan_of_share(F16 t) {
  const F16 s = t * t;
  return t * (0.9998660f + s * (-0.3302995f + s * (0.1801410f + s * (-0.0851330f + s * 0.0208351f))));
}

F16 atan2(F16 y, F16 x) {
  const F16 ax = abs(x), ay = abs(y);
  const F16 octant = atan_of_share(min(ax, ay) / max(max(ax, ay), 1e-30f));
  const F16 quadrant = select(ay > ax, static_cast<float>(0.5 * kPi) - octant, octant);
  const F16 half = select(x < 0.0f, static_cast<float>(kPi) - quadrant, quadrant);
  return select(y < 0.0f, -half, half);
}

/// Cell and weights of the first of four neighbouring B-splines at a place in cells.
struct Splines16 {
  I16 first;
  F16 weights[kSupport];
};
Splines16 splines_at(F16 place) {
  const F16 whole = floor(place);
  const F16 t = place - whole, s = 1.0f - t;
  constexpr float kSixth = 1.0f / 6.0f;
  return {to_int(whole) - 1,
          {kSixth * s * s * s, kSixth * (4.0f + t * t * (3.0f * t - 6.0f)),
           kSixth * (4.0f + s * s * (3.0f * s - 6.0f)), kSixth * t * t * t}};
}

/// The coefficients of the B-splines that interpolate a periodic sequence.
std::vector<double> spline_coefficients(const std::vector<double>& values) {
  // 1 / (1/6, 4/6, 1/6) is sqrt(3) z^|k| with the root z of its polynomial.
  const double root = std::sqrt(3.0) - 2.0;
  const auto n = static_cast<int>(values.size());
  std::vector<double> result(values.size(), 0.0);
  for (int i = 0; i < n; ++i) {
    double power = std::sqrt(3.0);
    for (int k = 0; k < 28; ++k, power *= root) {
      const double sum = values[static_cast<std::size_t>((i + k) % n)] +
                         (k > 0 ? values[static_cast<std::size_t>(((i - k) % n + n) % n)] : 0.0);
      result[static_cast<std::size_t>(i)] += power * sum;
    }
  }
  return result;
}

/// sums[row * stride] become the products of the table's rows with a column of `count` values.
template <int kRows>
void multiply_rows(const float* table, const Values* column, int count, Values* sums, std::ptrdiff_t stride) {
  F16 sum[kRows][2] = {};
  for (int k = 0; k < count; ++k) {
    const auto& [first, second] = column[k];
#pragma GCC unroll 8
    for (int row = 0; row < kRows; ++row) {
      const F16 factor = splat(table[row * count + k]);
      sum[row][0] += factor * first;
      sum[row][1] += factor * second;
    }
  }
  for (int row = 0; row < kRows; ++row) sums[row * stride] = {sum[row][0], sum[row][1]};
}

/// The same for any number of rows.
void multiply(const float* table, int rows, const Values* column, int count, Values* sums,
              std::ptrdiff_t stride) {
  while (rows > 0) {
    const int size = rows >= 8 ? 8 : rows >= 4 ? 4 : 1;
    const auto multiply_some = size == 8 ? multiply_rows<8> : size == 4 ? multiply_rows<4> : multiply_rows<1>;
    multiply_some(table, column, count, sums, stride);
    rows -= size;
    table += static_cast<std::ptrdiff_t>(size) * count;
    sums += size * stride;
  }
}

}  // namespace

ScatteredSums::ScatteredSums(int order)
    : order_(order),
      rows_(std::max(kFewestRows, static_cast<int>(std::ceil(kRowsPerOrder * order)))),
      columns_(2 * rows_) {
  const Basis basis(order);
  const double step = kPi / rows_;
  along_phi_.resize(static_cast<std::size_t>((2 * order + 1) * columns_));
  for (int m = 0; m <= order; ++m) {
    const double spline = (4.0 + 2.0 * std::cos(m * step)) / 6.0;
    for (int k = 0; k < columns_; ++k) {
      if (m > 0)
        along_phi_[static_cast<std::size_t>((2 * m - 1) * columns_ + k)] =
            static_cast<float>(std::cos(m * k * step) / spline);
      along_phi_[static_cast<std::size_t>(2 * m * columns_ + k)] =
          static_cast<float>((m > 0 ? std::sin(m * k * step) : 1.0) / spline);
    }
  }
  std::vector<std::vector<double>> y(static_cast<std::size_t>(rows_),
                                     std::vector<double>(static_cast<std::size_t>(basis.size())));
  for (int row = 0; row < rows_; ++row) {
    const double theta = (row + 0.5) * step;
    basis.evaluate({std::sin(theta), 0.0, std::cos(theta)}, y[static_cast<std::size_t>(row)]);
  }
  std::vector<double> around(static_cast<std::size_t>(2 * rows_));  // through both poles
  for (int m = 0; m <= order; ++m) {
    for (int l = m; l <= order; ++l) {
      for (int row = 0; row < rows_; ++row) {
        const double value = y[static_cast<std::size_t>(row)][static_cast<std::size_t>(index(l, m))];
        around[static_cast<std::size_t>(row)] = value;
        around[static_cast<std::size_t>(2 * rows_ - 1 - row)] = m % 2 == 0 ? value : -value;
      }
      const std::vector<double> coefficients = spline_coefficients(around);
      along_theta_.insert(along_theta_.end(), coefficients.begin(), coefficients.begin() + rows_);
    }
  }
}

std::size_t ScatteredSums::cell(int row, int column) const {
  return static_cast<std::size_t>((row + kRowMargin) * (columns_ + kSupport) + column + kColumnMargin);
}

void ScatteredSums::clear(Grid& grid) const {
  grid.cells.assign(cell(rows_ + kRowMargin, -kColumnMargin), Values{});
  grid.row_sums.resize(static_cast<std::size_t>((2 * order_ + 1) * rows_));
}

void ScatteredSums::add(I16 active, const V3x16& directions, std::span<const Values, kLanes> values,
                        Grid& grid) const {
  const float per_radian = static_cast<float>(rows_ / kPi);
  const F16 across = sqrt(directions.x * directions.x + directions.y * directions.y);
  const Splines16 theta = splines_at(per_radian * atan2(across, directions.z) - 0.5f);
  const F16 turn = per_radian * atan2(directions.y, directions.x);
  const Splines16 phi = splines_at(select(turn < 0.0f, turn + static_cast<float>(columns_), turn));
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (active[lane] == 0) continue;
    const auto& [first, second] = values[lane];
    Values* row = &grid.cells[cell(theta.first[lane], phi.first[lane])];
    for (int i = 0; i < kSupport; ++i, row += columns_ + kSupport) {
      const F16 row_weight = splat(theta.weights[i][lane]);
      const F16 a = row_weight * first, b = row_weight * second;
      for (int j = 0; j < kSupport; ++j) {
        const F16 weight = splat(phi.weights[j][lane]);
        row[j][0] += weight * a;
        row[j][1] += weight * b;
      }
    }
  }
}

/// What lies beyond the first or last column belongs to the other end of its row; beyond a pole to the
/// meridian on the other side.
void ScatteredSums::fold_margins(Grid& grid) const {
  const auto move = [&](int row, int column, int to_row, int to_column) {
    for (std::size_t i = 0; i < 2; ++i)
      grid.cells[cell(to_row, to_column)][i] += grid.cells[cell(row, column)][i];
  };
  for (int row = -kRowMargin; row < rows_ + kRowMargin; ++row) {
    move(row, -1, row, columns_ - 1);
    for (int k = 0; k < kSupport - kColumnMargin; ++k) move(row, columns_ + k, row, k);
  }
  for (int row = 0; row < kRowMargin; ++row) {
    for (int k = 0; k < columns_; ++k) {
      const int opposite = (k + rows_) % columns_;
      move(-1 - row, k, row, opposite);
      move(rows_ + row, k, rows_ - 1 - row, opposite);
    }
  }
}

std::vector<ScatteredSums::Values> ScatteredSums::sums(Grid& grid) const {
  fold_margins(grid);
  // A row for each cos(m phi) or sin(m phi), over the grid's rows.
  for (int row = 0; row < rows_; ++row)
    multiply(along_phi_.data(), 2 * order_ + 1, &grid.cells[cell(row, 0)], columns_,
             &grid.row_sums[static_cast<std::size_t>(row)], rows_);
  std::vector<Values> result(static_cast<std::size_t>(coefficient_count(order_)));
  std::vector<Values> bands(static_cast<std::size_t>(order_ + 1));
  const float* table = along_theta_.data();
  for (int m = 0; m <= order_; ++m) {
    const int count = order_ + 1 - m;
    for (const int signed_m : {-m, m}) {
      const int row = signed_m > 0 ? 2 * m - 1 : 2 * m;
      multiply(table, count, &grid.row_sums[static_cast<std::size_t>(row * rows_)], rows_, bands.data(), 1);
      for (int l = m; l <= order_; ++l)
        result[static_cast<std::size_t>(index(l, signed_m))] = bands[static_cast<std::size_t>(l - m)];
    }
    table += static_cast<std::ptrdiff_t>(count) * rows_;
  }
  return result;
}

}  // namespace vrc::sh
