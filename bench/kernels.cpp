// SPDX-License-Identifier: GPL-3.0-or-later
// Times the kernels that rendering spends its time in, on the glossy Cornell box, on one thread.
#include <benchmark/benchmark.h>

#include "core/parallel.h"
#include "core/sobol.h"
#include "io/scene_reader.h"
#include "placement/gather.h"
#include "placement/incident_harmonics.h"
#include "placement/place_records.h"
#include "placement/tile.h"
#include "placement/visible_points.h"
#include "shading/interpolate.h"
#include "transport/path_tracer.h"

namespace vrc {
namespace {

constexpr int kSize = 256;
constexpr PacketRange kAllPackets = {0, 1};  // Sixteen samples a pixel.

/// The scene and one picture's samples, made once.
struct Fixture {
  SceneDescription description = read();
  Scene scene{description};
  FilmSampler film{scene.camera(), scene.film(), 16, 1};
  TileLayout layout{0, 0, kSize, kSize};

  static SceneDescription read() {
    SceneReadOptions options;
    options.width = options.height = kSize;
    return read_scene(VRC_SOURCE_DIR "/scenes/cornell_glossy.xml", options);
  }
};

const Fixture& fixture() {
  set_thread_count(1);
  static const Fixture instance;
  return instance;
}

/// Sites spread over the picture.
std::vector<RecordSite> some_sites(const Fixture& f) {
  std::uint64_t camera_rays = 0;
  const PlacementView view = {0, 0, kSize, kSize, &f.film};
  const SceneCharts charts(f.scene);
  const VisiblePoints points = pixel_centres(charts, view, camera_rays);
  std::vector<RecordSite> sites;
  for (std::size_t i = 0; i < points.pilot_count(); ++i)
    sites.push_back(make_site(f.scene, points.surface_point(i), points.key(i)));
  return sites;
}

double as_double(std::uint64_t count) { return static_cast<double>(count); }

void gather_one_record(benchmark::State& state) {
  const Fixture& f = fixture();
  const std::vector<RecordSite> sites = some_sites(f);
  GatherOptions options;
  options.log2_rays = static_cast<int>(state.range(0));
  RayCounts counts;
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(gather_radiance(f.scene, sites[next++ % sites.size()], options, counts));
  }
  state.counters["gather rays"] = benchmark::Counter(as_double(counts.gather), benchmark::Counter::kIsRate);
  state.counters["all rays"] =
      benchmark::Counter(as_double(counts.gather + counts.shadow), benchmark::Counter::kIsRate);
}
BENCHMARK(gather_one_record)->Arg(12)->Arg(14)->Unit(benchmark::kMicrosecond);

/// Spherical harmonics of an order at the same sites, with derivatives of all coefficients.
void gather_harmonics(benchmark::State& state) {
  const Fixture& f = fixture();
  const std::vector<RecordSite> sites = some_sites(f);
  const HarmonicsGatherer gatherer(static_cast<int>(state.range(1)));
  GatherOptions options;
  options.log2_rays = static_cast<int>(state.range(0));
  RayCounts counts;
  HitDistances hits;
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(gatherer.gather(f.scene, sites[next++ % sites.size()], options, counts, hits));
  }
  state.counters["gather rays"] = benchmark::Counter(as_double(counts.gather), benchmark::Counter::kIsRate);
}
BENCHMARK(gather_harmonics)
    ->ArgNames({"log2_rays", "order"})
    ->Args({12, 6})
    ->Args({12, 10})
    ->Args({12, 16})
    ->Args({12, 24})
    ->Unit(benchmark::kMicrosecond);

void primary_rays(benchmark::State& state) {
  const Fixture& f = fixture();
  RayCounts counts;
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        trace_tile(f.scene, f.film, pixels_of(f.layout, next++ % f.layout.count()), kAllPackets, counts));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(counts.camera));
}
BENCHMARK(primary_rays)->Unit(benchmark::kMicrosecond);

void interpolate_samples(benchmark::State& state) {
  const Fixture& f = fixture();
  CacheOptions options;
  options.records = 1000;
  options.gather_rays = 1024;
  const PlacementView view = {0, 0, kSize, kSize, &f.film};
  PlacementResult placed = place_records(f.scene, view, options, 1, 1, {});
  const RadianceCache cache(placed.charts, std::move(placed.records), placed.reaches, placed.brdfs);
  RayCounts counts;
  const Tile tile =
      trace_tile(f.scene, f.film, pixels_of(f.layout, f.layout.count() / 2), kAllPackets, counts);
  for (auto _ : state) {
    const TileRecords records(cache, tile);
    for (std::size_t i = 0; i < tile.points.size(); ++i) benchmark::DoNotOptimize(interpolate(records, i, 2));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tile.points.size() * kLanes));
}
BENCHMARK(interpolate_samples)->Unit(benchmark::kMicrosecond);

void path_samples(benchmark::State& state) {
  const Fixture& f = fixture();
  RayCounts counts;
  const PathOptions options = {static_cast<int>(state.range(0)), true, false};
  const Tile tile =
      trace_tile(f.scene, f.film, pixels_of(f.layout, f.layout.count() / 2), kAllPackets, counts);
  for (auto _ : state) {
    for (std::size_t i = 0; i < tile.points.size(); ++i) {
      const CameraPacket& packet = tile.packets[i];
      const PathSampler16 sampler = {packet.sample_index, packet.pixel_seed};
      benchmark::DoNotOptimize(
          trace_paths(f.scene, tile.points[i], packet.direction, packet.active, sampler, options, counts));
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tile.points.size() * kLanes));
}
BENCHMARK(path_samples)->ArgName("bounces")->Arg(1)->Arg(4)->Unit(benchmark::kMicrosecond);

void fill_sobol_points(benchmark::State& state) {
  SobolGrid grid;
  std::uint64_t seed = 0;
  for (auto _ : state) {
    fill_sobol_grid(grid, static_cast<int>(state.range(0)), ++seed);
    benchmark::DoNotOptimize(grid.u[0].data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(grid.size()));
}
BENCHMARK(fill_sobol_points)->Arg(12)->Arg(14)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace vrc

BENCHMARK_MAIN();
