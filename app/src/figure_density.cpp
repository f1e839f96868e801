// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "core/types.h"

namespace vrc {
namespace {

constexpr double kProbesPerCell = 10.0;
constexpr std::size_t kFewestProbes = 3;  // cells with fewer lie at the picture's border

/// Position on a lattice, and the direction of the surface there.
using Cell = std::array<long, 6>;

struct Content {
  std::size_t records = 0, probes = 0;
  double wanted = 0.0;  // sum over the probes
};

Cell cell_of(const std::vector<double>& row, double side) {
  Cell cell;
  for (std::size_t i = 0; i < 3; ++i) {
    cell[i] = std::lround(row[i] / side);
    cell[3 + i] = std::lround(row[3 + i]);
  }
  return cell;
}

double wanted_density(const std::vector<double>& row) {
  const double brightness = static_cast<double>(
      luminance(Rgb(static_cast<float>(row[6]), static_cast<float>(row[7]), static_cast<float>(row[8]))));
  const double determinant = row[9] * row[11] - row[10] * row[10];
  return std::pow(std::abs(determinant), 0.25) / std::sqrt(std::max(brightness, 1e-12));
}

std::map<Cell, Content> cells_of(const std::vector<std::vector<double>>& records,
                                 const std::vector<std::vector<double>>& probes, double side) {
  std::map<Cell, Content> cells;
  for (const auto& row : records) ++cells[cell_of(row, side)].records;
  for (const auto& row : probes) {
    Content& content = cells[cell_of(row, side)];
    ++content.probes;
    content.wanted += wanted_density(row);
  }
  return cells;
}

std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> result(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    for (std::size_t k = first; k < end; ++k) result[order[k]] = 0.5 * static_cast<double>(first + end - 1);
    first = end;
  }
  return result;
}

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

/// Sum of products of the deviations from the means.
double comoment(std::span<const double> a, std::span<const double> b) {
  const double ma = mean(a), mb = mean(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - ma) * (b[i] - mb);
  return sum;
}

}  // namespace

double rank_correlation(std::span<const double> a, std::span<const double> b) {
  const std::vector<double> ra = ranks(a), rb = ranks(b);
  const double scale = std::sqrt(comoment(ra, ra) * comoment(rb, rb));
  return scale > 0.0 ? comoment(ra, rb) / scale : 0.0;
}

std::vector<std::string> density_columns() {
  return {"x", "y", "z", "nx", "ny", "nz", "L_r", "L_g", "L_b", "h11", "h12", "h22"};
}

RecordDensity record_density(const std::vector<std::vector<double>>& records,
                             const std::vector<std::vector<double>>& probes) {
  // A side at which the cells hold the wanted number of probes.
  double side = 1.0;
  for (int step = 0; step < 8; ++step) {
    const auto count = static_cast<double>(cells_of({}, probes, side).size());
    side *= std::sqrt(kProbesPerCell * count / static_cast<double>(std::max<std::size_t>(probes.size(), 1)));
  }
  std::vector<double> counts, probe_counts, wanted;
  for (const auto& [cell, content] : cells_of(records, probes, side)) {
    if (content.probes < kFewestProbes) continue;
    counts.push_back(static_cast<double>(content.records));
    probe_counts.push_back(static_cast<double>(content.probes));
    wanted.push_back(content.wanted / static_cast<double>(content.probes));
  }
  RecordDensity density;
  density.variation =
      std::sqrt(comoment(counts, counts) / static_cast<double>(std::max<std::size_t>(counts.size(), 1))) /
      std::max(mean(counts), 1e-30);
  density.correlation = rank_correlation(counts, wanted);
  const double others = rank_correlation(probe_counts, wanted), both = rank_correlation(counts, probe_counts);
  const double scale = std::sqrt((1.0 - others * others) * (1.0 - both * both));
  if (scale > 0.0) density.own_correlation = (density.correlation - others * both) / scale;
  return density;
}

}  // namespace vrc
