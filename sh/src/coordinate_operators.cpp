// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/coordinate_operators.h"

#include <vector>

#include "sh/basis.h"
#include "sh/derivatives.h"

namespace vrc::sh {

CoordinateOperators::CoordinateOperators(int order) {
  const RaisingOperators raising(order);
  const int rows = coefficient_count(order), columns = coefficient_count(order + 1);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Eigen::Triplet<double>> products, derivatives;
    for (int l = 0; l <= order; ++l) {
      for (int k = index(l, -l); k <= index(l, l); ++k) {
        for (const RaisedTerm& term : raising.terms(k, axis)) {
          if (term.factor == 0.0) continue;
          const double product = -term.factor / (2.0 * l + 1.0);
          products.emplace_back(k, term.index, product);
          derivatives.emplace_back(k, term.index, -l * product);
          if (l == order) continue;  // the row of the neighbour above is not there
          products.emplace_back(term.index, k, product);
          derivatives.emplace_back(term.index, k, (l + 2.0) * product);
        }
      }
    }
    const auto fill = [&](Matrix& m, const std::vector<Eigen::Triplet<double>>& entries) {
      m.resize(rows, columns);
      m.setFromTriplets(entries.begin(), entries.end());
    };
    fill(multiply[static_cast<std::size_t>(axis)], products);
    fill(differentiate[static_cast<std::size_t>(axis)], derivatives);
  }
}

}  // namespace vrc::sh
