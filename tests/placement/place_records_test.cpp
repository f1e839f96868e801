// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/place_records.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "placement/tile.h"
#include "placement_support.h"

namespace vrc {
namespace {

/// A scene with the samples that its picture is made of.
struct Picture {
  Scene scene;
  FilmSampler film{scene.camera(), scene.film(), 16, 1};
  PlacementView view;

  Picture(const std::string& name, int size)
      : scene(test::load_scene(name, size, size)), view{0, 0, size, size, &film} {}
  [[nodiscard]] PlacementResult place(const CacheOptions& options, const RunControl& control = {}) const {
    return place_records(scene, view, options, 1, 1, control);
  }
};

CacheOptions cheap(int records = 0, Sampler sampler = Sampler::kImage) {
  CacheOptions options;
  options.gather_rays = 1024;
  options.records = records;
  options.sampler = sampler;
  return options;
}

constexpr std::array kSamplers = {Sampler::kImage, Sampler::kSurface};

/// Samples that lie in no region, however wide they are used.
std::uint64_t uncovered_samples(const Picture& picture, const RadianceCache& cache) {
  const TileLayout layout = {picture.view.x0, picture.view.y0, picture.view.x1, picture.view.y1};
  std::uint64_t uncovered = 0;
  RayCounts counts;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    const Tile tile = trace_tile(picture.scene, picture.film, pixels_of(layout, i), {0, 1}, counts);
    const TileRecords records(cache, tile);
    for (std::size_t packet = 0; packet < tile.points.size(); ++packet) {
      I16 open = tile.points[packet].scatters;
      records.for_each(packet, static_cast<float>(kWideSupport), Deviation::kWidest,
                       [&](const PackedRecord&, const Coverage16& c) { open &= ~(c.weight > 0.0f); });
      uncovered += lane_count(open);
    }
  }
  return uncovered;
}

TEST(PlaceRecords, ReachesEverySampleOfThePicture) {
  for (const char* name : {"half_box.xml", "cornell_glossy.xml", "curved_room.xml"}) {
    const Picture picture(name, 64);
    for (const Sampler sampler : kSamplers) {
      CacheOptions options = cheap(0, sampler);
      options.error = sampler == Sampler::kImage ? 0.02 : 0.2;
      PlacementResult placed = picture.place(options);
      EXPECT_FALSE(placed.unfinished);
      EXPECT_GT(placed.records.size(), 20u);
      const RadianceCache cache(placed.charts, std::move(placed.records), placed.reaches, placed.brdfs);
      EXPECT_EQ(uncovered_samples(picture, cache), 0u) << name << ", sampler " << static_cast<int>(sampler);
    }
  }
}

/// The picture without an overture: records are made one after another, line by line.
TEST(PlaceRecords, WithoutAnOverturePixelsBlendOnlyWhatTheyOrEarlierOnesAskedFor) {
  const Picture picture("cornell_glossy.xml", 64);
  CacheOptions options = cheap();
  options.overture = options.joint_fit = options.hard_pixels = options.supersample_edges = false;
  PlacementResult placed = picture.place(options);
  const auto counted = static_cast<double>(placed.records.size());
  options.overture = true;
  EXPECT_NEAR(counted, static_cast<double>(picture.place(options).records.size()), 0.3 * counted);

  std::uint32_t latest = 0;
  std::size_t rising = 0;  // at the beginning; then come those of samples beside the pixels' centres
  for (; rising < placed.records.size() && placed.records[rising].turn >= latest; ++rising)
    latest = placed.records[rising].turn;
  EXPECT_GT(static_cast<double>(rising), 0.7 * counted);

  const RadianceCache cache(placed.charts, std::move(placed.records), placed.reaches, placed.brdfs);
  EXPECT_EQ(uncovered_samples(picture, cache), 0u);
  RayCounts counts;
  const Tile tile = trace_tile(picture.scene, picture.film, {{0, 0}, {40, 1}}, {0, 1}, counts);
  const TileRecords records(cache, tile);
  std::size_t blended = 0;
  for (const std::size_t packet : {0u, 1u}) {
    records.for_each(packet, 1.0f, Deviation::kAccepted, [&](const PackedRecord& record, const Coverage16&) {
      EXPECT_LE(record.turn, turn_of(tile.pixels[packet].x, tile.pixels[packet].y));
      ++blended;
    });
  }
  EXPECT_GE(blended, 2u);
}

TEST(PlaceRecords, WithAnOvertureEveryPixelMayBlendEveryRecord) {
  const Picture picture("cornell_glossy.xml", 64);
  for (const RadianceRecord& record : picture.place(cheap()).records) EXPECT_EQ(record.turn, 0u);
}

TEST(PlaceRecords, MakesTheWantedNumberOfRecords) {
  for (const char* name : {"half_box.xml", "cornell_glossy.xml"}) {
    const Picture picture(name, 128);
    for (const Sampler sampler : kSamplers) {
      for (const int wanted : {300, 1000}) {
        const auto made = static_cast<double>(picture.place(cheap(wanted, sampler)).records.size());
        EXPECT_NEAR(made, wanted, 0.05 * wanted) << name << ", sampler " << static_cast<int>(sampler);
      }
    }
  }
}

TEST(PlaceRecords, MakesNoMoreForFewerThanCoverThePicture) {
  const Picture picture("cornell_glossy.xml", 128);
  const auto made = [&](int wanted) { return picture.place(cheap(wanted)).records.size(); };
  const std::size_t enough = made(200);
  for (const int wanted : {20, 60, 120}) EXPECT_LE(made(wanted), enough) << wanted;
}

TEST(PlaceRecords, GivesRecordsTheWantedRaysOnAverage) {
  const Picture picture("half_box.xml", 64);
  CacheOptions options = cheap(300);
  options.gather_rays = 1280;
  const PlacementResult result = picture.place(options);
  double sum = 0.0;
  for (const RadianceRecord& r : result.records) {
    EXPECT_TRUE(r.rays == 1024 || r.rays == 2048);
    sum += static_cast<double>(r.rays);
  }
  // A quarter of the records has twice the rays: five standard deviations.
  const double count = static_cast<double>(result.records.size());
  EXPECT_NEAR(sum / count, 1280.0, 5.0 * 1024.0 * std::sqrt(0.25 * 0.75 / count));
}

TEST(PlaceRecords, MakesMoreRecordsForASmallerError) {
  const Picture picture("half_box.xml", 64);
  std::size_t previous = 0;
  for (const double error : {0.3, 0.1, 0.03}) {
    CacheOptions options = cheap();
    options.error = error;
    const PlacementResult placed = picture.place(options);
    EXPECT_GT(placed.records.size(), previous + previous / 4);
    previous = placed.records.size();
    EXPECT_GT(placed.counts.gather, 500u * previous);
    EXPECT_GT(placed.scale.mean_luminance, 0.0);
  }
}

TEST(PlaceRecords, FillsTheirFieldsWithFiniteNumbers) {
  const Picture picture("cornell_glossy.xml", 64);
  for (const RadianceRecord& r : picture.place(cheap()).records) {
    for (const Jet2& j : r.radiance) {
      for (const double v : test::entries(j)) EXPECT_TRUE(std::isfinite(v));
    }
    EXPECT_GT(r.region.radius1, 0.0);
    EXPECT_GT(r.region.radius2, 0.0);
    EXPECT_GT(r.region.normal_radius, 0.0);
    EXPECT_LE(r.clamp_factor, 1.0);
    EXPECT_EQ(r.region.center, r.site.point.position);
  }
}

TEST(PlaceRecords, IsTheSameAtAnyThreadCount) {
  const Picture picture("curved_room.xml", 64);
  for (const Sampler sampler : kSamplers) {
    set_thread_count(1);
    const PlacementResult one = picture.place(cheap(0, sampler));
    set_thread_count(2);
    const PlacementResult two = picture.place(cheap(0, sampler));
    ASSERT_EQ(one.records.size(), two.records.size());
    for (std::size_t i = 0; i < one.records.size(); ++i) {
      EXPECT_EQ(one.records[i].site.key, two.records[i].site.key);
      EXPECT_EQ(one.records[i].region.radius1, two.records[i].region.radius1);
      EXPECT_EQ(one.records[i].curvature.deviation, two.records[i].curvature.deviation);
      EXPECT_EQ(test::entries(one.records[i].radiance[0]), test::entries(two.records[i].radiance[0]));
    }
  }
}

/// Distances of the records to their nearest neighbours on the same surface, in units of their own radii.
std::vector<double> neighbour_distances(std::span<const RadianceRecord> records) {
  std::vector<double> distances;
  for (const RadianceRecord& a : records) {
    double nearest = 1e9;
    for (const RadianceRecord& b : records) {
      if (&a == &b || a.site.point.region != b.site.point.region) continue;
      nearest = std::min(nearest, joint_distance(a.region, b.region.center, b.region.normal));
    }
    distances.push_back(nearest);
  }
  std::ranges::sort(distances);
  return distances;
}

TEST(PlaceRecords, SurfaceSamplerKeepsNeighboursApartInTheirOwnMetric) {
  const Picture picture("glossy_pair.xml", 128);
  // A record's radii must not depend on which others there are: no guides; and without silhouettes, whose
  // few rays here make them vary; and they must be larger than a pixel.
  const auto distances = [&](Sampler sampler) {
    CacheOptions options = cheap(0, sampler);
    options.occlusion_aware = options.guided = false;
    options.error = 0.043;
    return neighbour_distances(picture.place(options).records);
  };
  const std::vector<double> image = distances(Sampler::kImage), surface = distances(Sampler::kSurface);
  EXPECT_GT(surface[surface.size() / 4], image[image.size() / 4]);
  EXPECT_GT(surface[surface.size() / 10], 0.5);
  EXPECT_LT(surface.size(), image.size());
}

TEST(RecordPlacer, KeepsItsRecordsWhenTheErrorIsLowered) {
  const Picture picture("cornell_glossy.xml", 64);
  const RunControl control;
  RecordPlacer placer(picture.scene, picture.view, {}, 1, 1, control);
  placer.cover(0.2);
  const PlacementResult coarse = placer.snapshot();
  EXPECT_GT(placer.relative_work(0.02), 8.0);
  EXPECT_DOUBLE_EQ(placer.relative_work(0.2), 1.0);
  placer.cover(0.02);
  const PlacementResult fine = placer.finish();
  ASSERT_GT(fine.records.size(), 3 * coarse.records.size() / 2);
  double coarse_noise = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < coarse.records.size(); ++i) {
    EXPECT_EQ(fine.records[i].site.key, coarse.records[i].site.key);
    EXPECT_GE(fine.records[i].rays, coarse.records[i].rays);
    coarse_noise += coarse.records[i].estimate.variance.value;
    noise += fine.records[i].estimate.variance.value;
  }
  EXPECT_LT(noise, 0.5 * coarse_noise);
  const RadianceCache cache(fine.charts, fine.records, fine.reaches, fine.brdfs);
  EXPECT_EQ(uncovered_samples(picture, cache), 0u);
}

TEST(RecordPlacer, StopsWhenThereAreEnough) {
  const Picture picture("cornell_glossy.xml", 64);
  const RunControl control;
  for (const Sampler sampler : kSamplers) {
    RecordPlacer placer(picture.scene, picture.view, cheap(0, sampler), 1, 1, control);
    int asked = 0;
    EXPECT_FALSE(placer.cover(0.05, [&] { return ++asked > 2; }));
    const double open = placer.open_share();
    EXPECT_GT(open, 0.0);
    EXPECT_LT(open, 0.9);
    // What is open lies everywhere.
    std::array<int, 4> records_of_quarter{};
    for (const RadianceRecord& record : placer.snapshot().records) {
      const Vec2 film = picture.scene.camera().film_position(record.site.point.position);
      ++records_of_quarter[(film.x() < 32.0 ? 0u : 1u) + (film.y() < 32.0 ? 0u : 2u)];
    }
    for (const int count : records_of_quarter) EXPECT_GT(count, 0);
    EXPECT_TRUE(placer.cover(0.05));
    EXPECT_EQ(placer.open_share(), 0.0);
    const PlacementResult placed = placer.finish();
    const RadianceCache cache(placed.charts, placed.records, placed.reaches, placed.brdfs);
    EXPECT_EQ(uncovered_samples(picture, cache), 0u);
  }
}

TEST(RecordPlacer, LeavesSamplesOpenWhenThereAreEnough) {
  const Picture picture("curved_room.xml", 64);
  const RunControl control;
  RecordPlacer placer(picture.scene, picture.view, {}, 1, 1, control);
  placer.cover(0.05, [] { return true; });
  const PlacementResult placed = placer.finish([] { return true; });
  EXPECT_EQ(placed.records.size(), 0u);
  EXPECT_FALSE(placed.unfinished);
}

TEST(SeesEdge, TellsPixelsWithSeveralSurfaces) {
  const Picture picture("half_box.xml", 64);
  const TileLayout layout = {0, 0, 64, 64};
  RayCounts counts;
  std::size_t edges = 0;
  for (std::size_t i = 0; i < layout.count(); ++i) {
    const Tile tile = trace_tile(picture.scene, picture.film, pixels_of(layout, i), {0, 1}, counts);
    for (std::size_t pixel = 0; pixel < tile.pixels.size(); ++pixel) {
      const SurfacePoint16& p = tile.points[pixel];
      bool several = false;
      for (int lane = 1; lane < kLanes; ++lane)
        several |= p.hit[lane] != p.hit[0] || p.region[lane] != p.region[0];
      EXPECT_EQ(sees_edge(tile, pixel), several);  // All surfaces are flat.
      if (several) ++edges;
    }
  }
  EXPECT_GT(edges, 40u);
  EXPECT_LT(edges, 400u);
  EXPECT_EQ(further_edge_samples(16), 112);
  EXPECT_EQ(further_edge_samples(1), 7);
  EXPECT_EQ(further_edge_samples(200), 0);
}

TEST(PlaceRecords, StopsWhenItIsAskedTo) {
  const Picture picture("cornell_glossy.xml", 64);
  std::atomic<bool> stop{false};
  RunControl control;
  control.stop = &stop;
  control.progress = [&](const ProgressUpdate& update) {
    if (update.records > 0) stop = true;
  };
  const PlacementResult placed = picture.place(cheap(), control);
  EXPECT_TRUE(placed.unfinished);
  const std::size_t all = picture.place(cheap()).records.size();
  EXPECT_LT(placed.records.size(), all / 2);
  EXPECT_GT(placed.records.size(), 0u);
}

TEST(PlaceRecords, MakesNoneWhereNothingReflects) {
  SceneReadOptions read;
  read.width = read.height = 32;
  SceneDescription description = read_scene(VRC_SOURCE_DIR "/scenes/half_box.xml", read);
  for (Material& material : description.materials) material.lobes.clear();
  const Scene scene(description);
  const FilmSampler film(scene.camera(), scene.film(), 16, 1);
  const PlacementResult placed = place_records(scene, {0, 0, 32, 32, &film}, cheap(), 1, 1, {});
  EXPECT_TRUE(placed.records.empty());
  EXPECT_FALSE(placed.unfinished);
}

TEST(PlaceRecords, ManagesAPictureWithoutLight) {
  SceneReadOptions read;
  read.width = read.height = 32;
  SceneDescription description = read_scene(VRC_SOURCE_DIR "/scenes/half_box.xml", read);
  for (ShapeDescription& shape : description.shapes) shape.emission.clear();
  const Scene scene(description);
  const FilmSampler film(scene.camera(), scene.film(), 16, 1);
  const PlacementResult placed = place_records(scene, {0, 0, 32, 32, &film}, cheap(), 1, 1, {});
  EXPECT_FALSE(placed.records.empty());
  for (const RadianceRecord& r : placed.records) {
    for (const Jet2& j : r.radiance) EXPECT_EQ(j.value, 0.0);
    EXPECT_TRUE(std::isfinite(r.region.radius1));
  }
}

}  // namespace
}  // namespace vrc
