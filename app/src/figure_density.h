// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

namespace vrc {

/// Spearman's rank correlation of two lists of the same length, ties at their mean rank; 0 when one is
/// constant.
[[nodiscard]] double rank_correlation(std::span<const double> a, std::span<const double> b);

/// The columns of a record map that densities are made of.
[[nodiscard]] std::vector<std::string> density_columns();

/// How records spread over the cells of a lattice on the surfaces.
struct RecordDensity {
  double variation = 0.0;  ///< Standard deviation of the counts of cells over their mean.
  /// Rank correlation of the counts with the density that eq. 4 wants, (|u1 u2|)^(1/4) / L^(1/2), in the mean
  /// of the `probes` in a cell.
  double correlation = 0.0;
  /// The same beyond what the numbers of probes in the cells explain: the partial correlation.
  double own_correlation = 0.0;
};

/// Of records, by rows of `density_columns`. `probes` are records of the same picture that lie elsewhere;
/// cells hold 10 probes on average.
[[nodiscard]] RecordDensity record_density(const std::vector<std::vector<double>>& records,
                                           const std::vector<std::vector<double>>& probes);

}  // namespace vrc
