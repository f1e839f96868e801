// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/projection.h"

#include <vector>

#include "core/error.h"

namespace vrc::sh {
namespace {

constexpr int kBatch = 4;

/// sums (n x channels) += y (n x kBatch) * weighted (kBatch x channels), lane by lane. A general
/// matrix product, which packs y first, takes 1.6 times as long for three channels.
void add_product(std::span<const F16> y, std::span<const F16> weighted, std::span<F16> sums) {
  const std::size_t channels = weighted.size() / kBatch;
  F16* sum = sums.data();
  for (const F16* row = y.data(); row != y.data() + y.size(); row += kBatch) {
    for (std::size_t c = 0; c < channels; ++c) {
      const F16* w = &weighted[c * kBatch];
      *sum++ += (row[0] * w[0] + row[1] * w[1]) + (row[2] * w[2] + row[3] * w[3]);
    }
  }
}

}  // namespace

Eigen::MatrixXd basis_table(const Basis& basis, const SphereQuadrature& rule) {
  // Filled transposed: the values of one direction are neighbours.
  Eigen::MatrixXd table(basis.size(), static_cast<Eigen::Index>(rule.directions.size()));
  for (Eigen::Index i = 0; i < table.cols(); ++i)
    basis.evaluate(rule.directions[i], {table.col(i).data(), static_cast<std::size_t>(table.rows())});
  return table.transpose();
}

Eigen::VectorXd project(int order, const std::function<double(const Vec3&)>& f, int degree) {
  const SphereQuadrature rule = sphere_quadrature(degree);
  Eigen::VectorXd values(static_cast<Eigen::Index>(rule.directions.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = rule.weights[i] * f(rule.directions[i]);
  return basis_table(Basis(order), rule).transpose() * values;
}

Eigen::MatrixXd project_samples(const Basis& basis, const SamplePackets& samples) {
  const std::size_t packets = samples.directions.size();
  VRC_CHECK(samples.weights.size() == packets, "{} weights for {} packets", samples.weights.size(), packets);
  const std::size_t channels = packets == 0 ? 0 : samples.values.size() / packets;
  VRC_CHECK(channels * packets == samples.values.size(), "{} values for {} packets", samples.values.size(),
            packets);
  // Packets missing in the last batch have weight 0.
  std::vector<F16> y(static_cast<std::size_t>(basis.size()) * kBatch), weighted(channels * kBatch);
  std::vector<F16> sums(static_cast<std::size_t>(basis.size()) * channels);
  for (std::size_t begin = 0; begin < packets; begin += kBatch) {
    for (std::size_t p = 0; p < kBatch; ++p) {
      const std::size_t packet = begin + p;
      if (packet < packets) basis.evaluate(samples.directions[packet], std::span(y).subspan(p), kBatch);
      for (std::size_t c = 0; c < channels; ++c)
        weighted[c * kBatch + p] =
            packet < packets ? samples.weights[packet] * samples.values[c * packets + packet] : F16{};
    }
    add_product(y, weighted, sums);
  }
  Eigen::MatrixXd result(basis.size(), static_cast<Eigen::Index>(channels));
  for (Eigen::Index j = 0; j < result.rows(); ++j) {
    for (Eigen::Index c = 0; c < result.cols(); ++c) result(j, c) = lane_sum(sums[j * result.cols() + c]);
  }
  return result;
}

}  // namespace vrc::sh
