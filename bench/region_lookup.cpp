// SPDX-License-Identifier: GPL-3.0-or-later
// Times the look-up of records by chart: candidates from the index, then the exact test of each
// ellipse. Five ellipses cover a point whatever their number. "along_rows" asks as a renderer does,
// point after point of a picture of one patch; "scattered" asks anywhere in all patches, where every
// look-up beyond the caches' size waits for memory several times.
#include <benchmark/benchmark.h>

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

double uniform(std::uint64_t key, std::uint64_t index) {
  return static_cast<double>(hash(key, index) >> 11) * 0x1.0p-53;
}

// Inside where |scaled (uv - center)| <= 1.
struct Ellipse {
  Vec2 center;
  Mat2 scaled;
};

struct Records {
  std::vector<Ellipse> ellipses;
  std::vector<PatchFootprint> footprints;
};

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
    records.ellipses.push_back({center, radii.cwiseInverse().asDiagonal() * axes.transpose()});
    const Vec2 half = (axes * radii.asDiagonal()).rowwise().norm();
    const auto patch = static_cast<std::uint32_t>(kPatches * uniform(6, i));
    records.footprints.push_back({i, patch, center - half, center + half});
  }
  Records sorted;
  for (const std::uint32_t i : spatial_order(count, records.footprints)) {
    const auto record = static_cast<std::uint32_t>(sorted.ellipses.size());
    sorted.ellipses.push_back(records.ellipses[i]);
    sorted.footprints.push_back(records.footprints[i]);
    sorted.footprints.back().record = record;
  }
  return sorted;
}

struct Query {
  std::uint32_t patch;
  Vec2 uv;
};

Query scattered_query(std::uint64_t i) {
  const std::uint64_t bits = hash(7, i);
  const auto coordinate = [](std::uint64_t v) { return static_cast<double>(v & 0xffffff) * 0x1.0p-24; };
  return {static_cast<std::uint32_t>(bits >> 48) % kPatches, {coordinate(bits), coordinate(bits >> 24)}};
}

Query row_query(std::uint64_t i) {
  const auto coordinate = [](std::uint64_t v) { return (static_cast<double>(v % kRow) + 0.5) / kRow; };
  return {3, {coordinate(i), coordinate(i / kRow)}};
}

template <typename MakeQuery>
void look_up(benchmark::State& state, const MakeQuery& make_query) {
  const Records records = make_records(static_cast<std::size_t>(state.range(0)));
  const RegionIndex index(kPatches, records.footprints);
  std::uint64_t next = 0;
  std::int64_t candidates = 0;
  std::int64_t covering = 0;
  for (auto _ : state) {
    const Query query = make_query(next++);
    std::int64_t hits = 0;
    const std::span<const std::uint32_t> found = index.candidates(query.patch, query.uv);
    for (const std::uint32_t i : found) {
      const Ellipse& ellipse = records.ellipses[i];
      hits += (ellipse.scaled * (query.uv - ellipse.center)).squaredNorm() <= 1.0 ? 1 : 0;
    }
    candidates += static_cast<std::int64_t>(found.size());
    benchmark::DoNotOptimize(covering += hits);
  }
  const auto per_query = benchmark::Counter::kAvgIterations;
  state.SetItemsProcessed(state.iterations());
  state.counters["candidates"] = benchmark::Counter(static_cast<double>(candidates), per_query);
  state.counters["covering"] = benchmark::Counter(static_cast<double>(covering), per_query);
  state.counters["bytes/record"] =
      static_cast<double>(index.memory()) / static_cast<double>(records.ellipses.size());
}

void along_rows(benchmark::State& state) { look_up(state, row_query); }
BENCHMARK(along_rows)->RangeMultiplier(10)->Range(10'000, 1'000'000);

void scattered(benchmark::State& state) { look_up(state, scattered_query); }
BENCHMARK(scattered)->RangeMultiplier(10)->Range(10'000, 1'000'000);

void build(benchmark::State& state) {
  const Records records = make_records(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(RegionIndex(kPatches, records.footprints).entry_count());
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(build)->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vrc

BENCHMARK_MAIN();
