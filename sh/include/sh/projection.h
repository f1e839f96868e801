// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>

#include "core/simd.h"
#include "sh/basis.h"
#include "sh/quadrature.h"

namespace vrc::sh {

/// Y_j(direction_i) in row i, column j, for the rule's directions.
[[nodiscard]] Eigen::MatrixXd basis_table(const Basis& basis, const SphereQuadrature& rule);

/// The coefficients integral of f Y_lm dw [unit of f times sr^1/2] by `sphere_quadrature(degree)`: exact
/// for an f of order degree - order, otherwise as accurate as the rule is for f Y_lm.
[[nodiscard]] Eigen::VectorXd project(int order, const std::function<double(const Vec3&)>& f, int degree);

/// Monte Carlo samples of functions of direction (channels), sixteen to a packet.
struct SamplePackets {
  std::span<const V3x16> directions;  ///< Unit vectors, one packet each.
  /// 1 / (N pdf) [sr] for N samples; 0 for lanes that hold none (their direction must be finite).
  std::span<const F16> weights;
  /// Channel c of packet p at [c * directions.size() + p].
  std::span<const F16> values;
};

/// Sum over the samples of weight * value * Y_lm: row index(l, m), one column a channel. The estimator
/// of `project`; calls for parts of the samples add up. Lanes are summed apart in single precision by
/// matrix products of four packets, so split more than 2^18 samples. A logic_error if the sizes of the
/// spans do not fit.
[[nodiscard]] Eigen::MatrixXd project_samples(const Basis& basis, const SamplePackets& samples);

}  // namespace vrc::sh
