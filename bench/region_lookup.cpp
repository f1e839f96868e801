// SPDX-License-Identifier: GPL-3.0-or-later
// Times the look-up of the records that cover a point of a chart. Five ellipses cover a point whatever
// their number. "along_rows" asks as a renderer does, point after point of a picture of one patch;
// "scattered" asks anywhere in all patches, where a look-up beyond the caches' size waits for memory;
// "in_batches" asks for 16 points at once, which wait together.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/hash.h"
#include "geometry/region_index.h"

namespace vrc {
namespace {

constexpr std::uint32_t kPatches = 16;  // Unit squares.
constexpr double kCover = 5.0;
constexpr std::uint64_t kRow = 1024;  // Points of a row, and rows.
constexpr std::size_t kBatch = 16;

double uniform(std::uint64_t key, std::uint64_t index) {
  return static_cast<double>(hash(key, index) >> 11) * 0x1.0p-53;
}

using Records = std::vector<PatchFootprint>;  // Record i is that of footprint i.

// Placed anywhere, in spatial order; areas vary by e^2 and axes by up to 4 to 1.
Records make_records(std::size_t count) {
  Records records;
  const double mean_area = kCover * kPatches / static_cast<double>(count);
  const double log_spread = 2.0;
  const double normaliser = log_spread / (std::exp(log_spread) - 1.0);  // Makes the mean area right.
  for (std::uint32_t i = 0; i < count; ++i) {
    const double area = mean_area * normaliser * std::exp(log_spread * uniform(1, i));
    const double aspect = 1.0 + 3.0 * uniform(2, i);
    const double angle = 2.0 * kPi * uniform(3, i);
    const Vec2 radii = std::sqrt(area / kPi) * Vec2(std::sqrt(aspect), 1.0 / std::sqrt(aspect));
    const Mat2 axes = Eigen::Rotation2Dd(angle).toRotationMatrix();
    const Vec2 center(uniform(4, i), uniform(5, i));
    const Vec2 half = (axes * radii.asDiagonal()).rowwise().norm();
    const auto patch = static_cast<std::uint32_t>(kPatches * uniform(6, i));
    records.push_back({i, patch, center - half, center + half, center,
                       radii.cwiseInverse().asDiagonal() * axes.transpose()});
  }
  Records sorted;
  for (const std::uint32_t i : spatial_order(count, records)) {
    sorted.push_back(records[i]);
    sorted.back().record = static_cast<std::uint32_t>(sorted.size() - 1);
  }
  return sorted;
}

PatchPoint scattered_point(std::uint64_t i) {
  const std::uint64_t bits = hash(7, i);
  const auto coordinate = [](std::uint64_t v) { return static_cast<double>(v & 0xffffff) * 0x1.0p-24; };
  return {static_cast<std::uint32_t>(bits >> 48) % kPatches, {coordinate(bits), coordinate(bits >> 24)}};
}

PatchPoint row_point(std::uint64_t i) {
  const auto coordinate = [](std::uint64_t v) { return (static_cast<double>(v % kRow) + 0.5) / kRow; };
  return {3, {coordinate(i), coordinate(i / kRow)}};
}

// How many candidates a point has, how many of them the index returns, and how many cover it.
template <typename MakePoint>
void count_answers(benchmark::State& state, const Records& records, const RegionIndex& index,
                   const MakePoint& make_point) {
  constexpr std::uint64_t kSamples = 10000;
  double candidates = 0.0, returned = 0.0, covering = 0.0;
  std::vector<std::uint32_t> found;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const PatchPoint point = make_point(37 * i);
    candidates += static_cast<double>(index.candidates(point.patch, point.uv).size());
    found.clear();
    index.covering(point, found);
    returned += static_cast<double>(found.size());
    for (const std::uint32_t r : found) {
      const PatchFootprint& f = records[r];
      covering += (f.shape * (point.uv - f.center)).squaredNorm() <= 1.0 ? 1.0 : 0.0;
    }
  }
  state.counters["candidates"] = candidates / kSamples;
  state.counters["returned"] = returned / kSamples;
  state.counters["covering"] = covering / kSamples;
  state.counters["bytes/record"] = static_cast<double>(index.memory()) / static_cast<double>(records.size());
}

template <typename MakePoint>
void one_by_one(benchmark::State& state, const MakePoint& make_point) {
  const Records records = make_records(static_cast<std::size_t>(state.range(0)));
  const RegionIndex index(kPatches, records);
  std::uint64_t next = 0;
  std::vector<std::uint32_t> found;
  for (auto _ : state) {
    found.clear();
    index.covering(make_point(next++), found);
    benchmark::DoNotOptimize(found.data());
  }
  state.SetItemsProcessed(state.iterations());
  count_answers(state, records, index, make_point);
}

template <typename MakePoint>
void in_batches(benchmark::State& state, const MakePoint& make_point) {
  const Records records = make_records(static_cast<std::size_t>(state.range(0)));
  const RegionIndex index(kPatches, records);
  std::array<PatchPoint, kBatch> points;
  std::uint64_t next = 0;
  RecordsOfPoints found;
  for (auto _ : state) {
    for (PatchPoint& point : points) point = make_point(next++);
    index.covering(points, found);
    benchmark::DoNotOptimize(found.records.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kBatch));
  count_answers(state, records, index, make_point);
}

void along_rows(benchmark::State& state) { one_by_one(state, row_point); }
BENCHMARK(along_rows)->RangeMultiplier(10)->Range(10'000, 1'000'000);

void along_rows_in_batches(benchmark::State& state) { in_batches(state, row_point); }
BENCHMARK(along_rows_in_batches)->RangeMultiplier(10)->Range(10'000, 1'000'000);

void scattered(benchmark::State& state) { one_by_one(state, scattered_point); }
BENCHMARK(scattered)->RangeMultiplier(10)->Range(10'000, 1'000'000);

void scattered_in_batches(benchmark::State& state) { in_batches(state, scattered_point); }
BENCHMARK(scattered_in_batches)->RangeMultiplier(10)->Range(10'000, 1'000'000);

void build(benchmark::State& state) {
  const Records records = make_records(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(RegionIndex(kPatches, records).entry_count());
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(build)->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vrc

BENCHMARK_MAIN();
