// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/scattered_sums.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sh/basis.h"
#include "sh/sh_support.h"

namespace vrc::sh {
namespace {

constexpr double kMost = 7e-3;  // relative error of the last band

/// Sums by a basis, in double precision, of values[2][16] per direction.
std::vector<std::array<std::array<double, kLanes>, 2>> direct_sums(
    const Basis& basis, const std::vector<Vec3>& directions,
    const std::vector<ScatteredSums::Values>& values) {
  std::vector<std::array<std::array<double, kLanes>, 2>> sums(static_cast<std::size_t>(basis.size()));
  std::vector<double> y(sums.size());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    basis.evaluate(directions[i], y);
    for (std::size_t j = 0; j < y.size(); ++j) {
      for (std::size_t half = 0; half < 2; ++half) {
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          sums[j][half][lane] += y[j] * static_cast<double>(values[i][half][lane]);
      }
    }
  }
  return sums;
}

/// RMS of the errors of each band over the RMS of its sums.
std::vector<double> relative_errors(int order, const std::vector<Vec3>& directions, test::ShRandom& random) {
  const ScatteredSums scattered(order);
  std::vector<ScatteredSums::Values> values(directions.size());
  for (auto& v : values) {
    for (F16& half : v) {
      for (int lane = 0; lane < kLanes; ++lane) half[lane] = static_cast<float>(random.normal());
    }
  }
  ScatteredSums::Grid grid;
  scattered.clear(grid);
  for (std::size_t i = 0; i < directions.size(); i += kLanes) {
    V3x16 d{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Vec3f v = directions[i + lane].cast<float>();
      d.x[lane] = v.x();
      d.y[lane] = v.y();
      d.z[lane] = v.z();
    }
    scattered.add(I16{} - 1, d, std::span<const ScatteredSums::Values, kLanes>(&values[i], kLanes), grid);
  }
  const auto sums = scattered.sums(grid);
  const auto expected = direct_sums(Basis(order), directions, values);
  std::vector<double> result;
  for (int l = 0; l <= order; ++l) {
    double error = 0.0, size = 0.0;
    for (int m = -l; m <= l; ++m) {
      const auto j = static_cast<std::size_t>(index(l, m));
      for (std::size_t half = 0; half < 2; ++half) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
          error += std::pow(static_cast<double>(sums[j][half][lane]) - expected[j][half][lane], 2);
          size += std::pow(expected[j][half][lane], 2);
        }
      }
    }
    result.push_back(std::sqrt(error / size));
  }
  return result;
}

/// Random directions, the poles among them, and a narrow lobe of others around `axis`.
std::vector<Vec3> scattered_directions(const Vec3& axis, test::ShRandom& random) {
  std::vector<Vec3> result = test::test_directions(116);  // and twelve of its own
  while (result.size() < 512) result.push_back((axis + 0.1 * random.direction()).normalized());
  return result;
}

TEST(ScatteredSums, AreThoseOfTheBasis) {
  test::ShRandom random(3);
  for (const int order : {0, 1, 3, 10, 18, 26}) {
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitZ()),
                             random.direction(), Vec3(-1.0, 1e-4, 0.0)}) {
      const std::vector<double> errors = relative_errors(order, scattered_directions(axis, random), random);
      for (int l = 0; l <= order; ++l) {
        const double share = order > 0 ? static_cast<double>(l) / order : 0.0;
        RecordProperty("order_" + std::to_string(order) + "_band_" + std::to_string(l),
                       std::to_string(errors[static_cast<std::size_t>(l)]));
        EXPECT_LT(errors[static_cast<std::size_t>(l)], 1e-4 + kMost * std::pow(share, 4))
            << "band " << l << " of order " << order;
      }
    }
  }
}

TEST(ScatteredSums, DoNotReadInactiveLanes) {
  const ScatteredSums scattered(4);
  ScatteredSums::Grid grid;
  scattered.clear(grid);
  std::array<ScatteredSums::Values, kLanes> values{};
  for (auto& v : values) v[0] = v[1] = splat(std::nanf(""));
  values[3][0] = splat(2.0f);
  values[3][1] = splat(-1.0f);
  I16 third{};
  third[3] = -1;
  V3x16 d = {splat(std::nanf("")), splat(0.0f), splat(0.0f)};
  d.x[3] = 1.0f;
  scattered.add(third, d, values, grid);
  const auto sums = scattered.sums(grid);
  EXPECT_NEAR(sums[0][0][0], 2.0 * std::sqrt(0.25 / kPi), 1e-5);
  EXPECT_NEAR(sums[0][1][15], -std::sqrt(0.25 / kPi), 1e-5);
}

TEST(ScatteredSums, RefuseOrdersThatNoBasisHas) {
  EXPECT_THROW(ScatteredSums(-1), std::logic_error);
  EXPECT_THROW(ScatteredSums(kMaxOrder + 1), std::logic_error);
}

}  // namespace
}  // namespace vrc::sh
