// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/projection.h"

#include <algorithm>
#include <vector>

#include "core/error.h"

namespace vrc::sh {
namespace {

// Few enough that the table of basis values of order 24 stays in the second-level cache; one vector
// more in a row keeps the rows from falling into the same cache sets.
constexpr int kBatch = 4;
constexpr int kStride = kBatch + 1;

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Table = Eigen::Map<const RowMajor, Eigen::Aligned64, Eigen::OuterStride<kStride * kLanes>>;

const float* floats(const std::vector<F16>& v) { return reinterpret_cast<const float*>(v.data()); }

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
  std::vector<F16> y(static_cast<std::size_t>(basis.size()) * kStride), weighted(channels * kBatch);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(basis.size(), static_cast<Eigen::Index>(channels));
  Eigen::MatrixXf part(sum.rows(), sum.cols());
  for (std::size_t begin = 0; begin < packets; begin += kBatch) {
    const std::size_t count = std::min<std::size_t>(kBatch, packets - begin);
    for (std::size_t p = 0; p < count; ++p) {
      basis.evaluate(samples.directions[begin + p], std::span(y).subspan(p), kStride);
      for (std::size_t c = 0; c < channels; ++c)
        weighted[c * kBatch + p] = samples.weights[begin + p] * samples.values[c * packets + begin + p];
    }
    const auto lanes = static_cast<Eigen::Index>(count) * kLanes;
    const Table table(floats(y), sum.rows(), lanes);
    const Eigen::Map<const Eigen::MatrixXf, Eigen::Aligned64, Eigen::OuterStride<kBatch * kLanes>> values(
        floats(weighted), lanes, sum.cols());
    part.noalias() = table * values;
    sum += part.cast<double>();
  }
  return sum;
}

}  // namespace vrc::sh
