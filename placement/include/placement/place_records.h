// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>

#include "core/run_control.h"
#include "core/timing.h"
#include "placement/cache_options.h"
#include "placement/radiance_cache.h"
#include "transport/film_sampler.h"

namespace vrc {

/// The part of the picture that records must cover.
struct PlacementView {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< Pixels [x0, x1) x [y0, y1).
  const FilmSampler* film = nullptr;   ///< The samples that will be shaded.
};

/// What a placement learns from the picture.
struct PictureScale {
  double mean_luminance = 0.0;  ///< Of the indirect light.
  double log2_rays = 0.0;       ///< Of records, of which each has one of the powers of two beside it.
  double error = 0.0;           ///< That records were placed for last.
};

/// The records of earlier frames, which show what they can of the next one. They must serve any camera:
/// Representation::kHarmonics or kIrradiance, made with the same options.
struct EarlierFrames {
  const RadianceCache* cache = nullptr;
  PictureScale scale;
};

struct PlacementResult {
  std::shared_ptr<const SceneCharts> charts;
  std::vector<RadianceRecord> records;
  std::shared_ptr<const BrdfHarmonicsSet> brdfs;  ///< For records of spherical harmonics, or null.
  std::vector<SurfaceReach> reaches;              ///< Of the records, at kWideSupport.
  RayCounts counts;
  std::vector<PhaseTime> phases;
  double epsilon = 0.0;  ///< The threshold that was used (RegionRule::epsilon).
  PictureScale scale;
  bool unfinished = false;  ///< Stopped by the user: not every point is covered.
};

/// The records of a placement, to be looked up.
[[nodiscard]] RadianceCache cache_of(PlacementResult&& placed);

/// Points that nothing covers are reached by regions widened so far, and up to the widest deviation of
/// normals, before they get records.
inline constexpr double kWideSupport = 3.0;

/// Places records in rounds: points that no region covers yet become records, gathered in parallel
/// against the frozen cache and admitted in order, until every visible point and then every sample is
/// covered. `CacheOptions::sampler` says which points are taken next. Deterministic at any thread count.
/// With earlier frames only what their records leave open gets new ones, which come after them.
[[nodiscard]] PlacementResult place_records(const Scene& scene, const PlacementView& view,
                                            const CacheOptions& options, int bounces, std::uint64_t seed,
                                            const RunControl& control, const EarlierFrames& earlier = {});

/// The same step by step, for those who watch the time.
class RecordPlacer {
 public:
  /// All must outlive it but the options.
  RecordPlacer(const Scene& scene, const PlacementView& view, const CacheOptions& options, int bounces,
               std::uint64_t seed, const RunControl& control, const EarlierFrames& earlier = {});
  ~RecordPlacer();
  RecordPlacer(const RecordPlacer&) = delete;
  RecordPlacer& operator=(const RecordPlacer&) = delete;

  /// Covers every visible point with records for this accepted error, or with the options' number of them.
  /// The records there are stay; if the error is lower than before, they get the rays that it asks for beside
  /// their own. Stops early, with points left open all over the picture, when `enough` says so. Returns
  /// whether all are covered.
  bool cover(double error, const std::function<bool()>& enough = {});
  /// Of the visible points, the share that no record covers.
  [[nodiscard]] double open_share() const;
  /// About the work for records of this accepted error over that for those there are.
  [[nodiscard]] double relative_work(double error) const;
  /// What there is, all refined as it can be shaded, every sample covered or not; covering may go on.
  [[nodiscard]] PlacementResult snapshot();
  /// What there is, all refined. Only once. Before, camera samples that lie between the covered points get
  /// records, too, until `enough` says so.
  [[nodiscard]] PlacementResult finish(const std::function<bool()>& enough = {});

 private:
  class Placement;
  std::unique_ptr<Placement> placement_;
};

/// Rays of a gather for a wish for at least `rays`, as a power of two: GatherOptions::log2_rays.
[[nodiscard]] int log2_rays_for(int rays);

}  // namespace vrc
