// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/central_differences.h"

#include <gtest/gtest.h>

namespace vrc {
namespace {

TEST(CentralDifferences, AreExactForQuadraticFunctions) {
  const double h1 = 0.5, h2 = 0.25;
  StencilValues<double> f;
  for (std::size_t i = 0; i < f.size(); ++i) {
    const double x = h1 * kDifferenceStencil[i][0], y = h2 * kDifferenceStencil[i][1];
    f[i] = 3.0 + 2.0 * x - y + 4.0 * x * x - 5.0 * x * y + 0.5 * y * y;
  }
  const auto d = central_differences(f, h1, h2);
  const double expected[] = {3.0, 2.0, -1.0, 8.0, -5.0, 1.0};
  for (std::size_t k = 0; k < d.size(); ++k) EXPECT_NEAR(d[k], expected[k], 1e-12) << "entry " << k;
}

}  // namespace
}  // namespace vrc
