// SPDX-License-Identifier: GPL-3.0-or-later
// Times the kernels of the spherical harmonics, on one thread; the argument is the order.
#include <benchmark/benchmark.h>

#include <vector>

#include "sh/derivatives.h"
#include "sh/frame_rotator.h"
#include "sh/product.h"
#include "sh/projection.h"
#include "sh/rotation.h"

namespace vrc::sh {
namespace {

const Frame kFrame = Frame::around(Vec3(0.3, -0.5, 0.7).normalized());

int order_of(const benchmark::State& state) { return static_cast<int>(state.range(0)); }

std::vector<V3x16> directions(std::size_t packets) {
  std::vector<V3x16> result(packets);
  for (std::size_t p = 0; p < packets; ++p) {
    const F16 phase = to_float(lane_index()) + 0.1f * static_cast<float>(p);
    result[p] = normalize(V3x16{phase - 8.0f, splat(3.0f), 2.0f * phase - 11.0f});
  }
  return result;
}

/// Sixteen directions an iteration.
void evaluate_sixteen(benchmark::State& state) {
  const Basis basis(order_of(state));
  const std::vector<V3x16> packets = directions(64);
  std::vector<F16> out(basis.size());
  std::size_t next = 0;
  for (auto _ : state) {
    basis.evaluate(packets[next++ % packets.size()], out);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * basis.size() * kLanes);
}
BENCHMARK(evaluate_sixteen)->Arg(10)->Arg(24);

/// One direction an iteration.
void evaluate_jets(benchmark::State& state) {
  const DerivativeBasis basis(order_of(state));
  for (auto _ : state) benchmark::DoNotOptimize(basis.evaluate(kFrame.normal));
}
BENCHMARK(evaluate_jets)->Arg(10)->Arg(24);

/// 4096 samples an iteration; the second argument is the number of channels.
void project_4096_samples(benchmark::State& state) {
  const Basis basis(order_of(state));
  const std::vector<V3x16> packets = directions(256);
  const std::vector<F16> weights(256, splat(1.0f)), values(256 * state.range(1), splat(0.5f));
  for (auto _ : state) benchmark::DoNotOptimize(project_samples(basis, {packets, weights, values}));
}
BENCHMARK(project_4096_samples)
    ->Args({10, 3})
    ->Args({10, 18})
    ->Args({24, 3})
    ->Args({24, 18})
    ->Unit(benchmark::kMicrosecond);

/// One vector an iteration.
void rotate_by_frame(benchmark::State& state) {
  const FrameRotator rotator(order_of(state));
  const Eigen::VectorXf local = Eigen::VectorXf::Ones(coefficient_count(order_of(state)));
  Eigen::VectorXf world(local.size());
  for (auto _ : state) {
    rotator.rotate(kFrame, local, world);
    benchmark::DoNotOptimize(world.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(rotate_by_frame)->Arg(10)->Arg(24);

/// Making the matrices and rotating one vector.
void rotate_by_matrices(benchmark::State& state) {
  const Eigen::VectorXd local = Eigen::VectorXd::Ones(coefficient_count(order_of(state)));
  Mat3 r;
  r << kFrame.tangent, kFrame.bitangent, kFrame.normal;
  for (auto _ : state) benchmark::DoNotOptimize(Rotation(order_of(state), r).apply(local));
}
BENCHMARK(rotate_by_matrices)->Arg(10)->Arg(24)->Unit(benchmark::kMicrosecond);

void multiply(benchmark::State& state) {
  const int order = order_of(state);
  const Product product(order, order, order);
  const Eigen::VectorXd a = Eigen::VectorXd::Ones(coefficient_count(order));
  for (auto _ : state) benchmark::DoNotOptimize(product(a, a));
}
BENCHMARK(multiply)->Arg(10)->Arg(24)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace vrc::sh

BENCHMARK_MAIN();
