// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/place_records.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/parallel.h"
#include "open_samples.h"
#include "placement/joint_fit.h"
#include "placement/record_factory.h"
#include "placement/visible_points.h"
#include "point_chooser.h"

namespace vrc {
namespace {

constexpr int kLog2PilotRays = 10;
// Of the accepted error: a record's own noise, and that beyond which it is gathered again. The batches of
// guided rays, which converge faster than their batches, show about twice the deviation there is.
constexpr double kNoiseShare = 1.0, kGuidedNoiseShare = 2.0;
constexpr double kNoiseLimit = 2.5;  // times the noise share
constexpr int kSampleRounds = 24;    // passes over the samples that the points miss
constexpr int kCountRounds = 80;     // steps of the search for a wanted number of records
constexpr int kWidenSteps = 6;
constexpr double kCoarsestError = 2.0;  // where that search begins

class Placement {
 public:
  Placement(const Scene& scene, const PlacementView& view, const CacheOptions& options, int bounces,
            std::uint64_t seed, const RunControl& control, const EarlierFrames& earlier)
      : scene_(scene),
        view_(view),
        options_(options),
        control_(control),
        charts_(earlier.cache != nullptr ? earlier.cache->shared_charts() : make_charts()),
        factory_(*charts_, options, earlier.cache != nullptr ? earlier.cache->brdfs() : nullptr),
        points_(options.sampler == Sampler::kImage ? pixel_centres(*charts_, view, result_.counts.camera)
                                                   : film_points(*charts_, view, result_.counts.camera)),
        guides_(scene) {
    gather_.bounces = bounces;
    gather_.glossy_glossy = options.glossy_glossy;
    gather_.total_derivative = options.total_derivative;
    gather_.occlusion_aware = options.occlusion_aware;
    gather_.seed = seed;
    rule_.options = &options_;
    rule_.picture_width = std::max(scene.camera().width, scene.camera().height);
    if (earlier.cache != nullptr) {
      const auto records = earlier.cache->records();
      result_.records.assign(records.begin(), records.end());
      result_.scale = earlier.scale;
    }
    if (options.sampler == Sampler::kImage)
      chooser_ = std::make_unique<OrderedChooser>(points_);
    else
      chooser_ = std::make_unique<FrontChooser>(*charts_, points_);
  }

  PlacementResult run() {
    PhaseTimer timer("place records");
    if (result_.scale.log2_rays == 0) pilot();
    rule_.mean_luminance = result_.scale.mean_luminance;
    gather_.log2_rays = result_.scale.log2_rays;
    if (options_.gather_rays == 0) noise_goal_ = {kNoiseLimit * accepted_noise(), rule_.mean_luminance};
    if (options_.records > 0) {
      reach_count();
    } else {
      sweep(threshold(options_.error), *chooser_);
      if (!result_.unfinished) cover_samples();
    }
    reach_widely();
    result_.phases.push_back(timer.elapsed());
    if (options_.joint_fit) {
      PhaseTimer fit_timer("fit records");
      fit_jointly(*charts_, result_.records, result_.reaches, rule_);
      result_.phases.push_back(fit_timer.elapsed());
    }
    PhaseTimer class_timer("classify sites");
    classify();
    result_.phases.push_back(class_timer.elapsed());
    result_.charts = charts_;
    result_.brdfs = factory_.brdfs();
    result_.epsilon = rule_.epsilon;
    return std::move(result_);
  }

 private:
  std::shared_ptr<const SceneCharts> make_charts() {
    PhaseTimer timer("charts");
    auto charts = std::make_shared<const SceneCharts>(scene_);
    result_.phases.push_back(timer.elapsed());
    return charts;
  }

  /// The threshold of eq. 4 that gave a relative error in measurements (docs/decisions).
  static double threshold(double error) {
    return std::min(0.12 * error * error, 133.0 * error * error * error * error);
  }

  void make(const std::vector<RecordSite>& sites, const RecordFactory& factory) {
    std::vector<RadianceRecord> made(sites.size());
    std::vector<RayCounts> counts(sites.size());
    parallel_for(sites.size(), [&](std::size_t i) {
      if (!control_.stopped()) made[i] = factory.make(sites[i], gather_, noise_goal_, counts[i], &guides_);
    });
    if (control_.stopped()) {
      result_.unfinished = true;
      return;
    }
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (made[i].found) guides_.add(made[i].site, made[i].found);
      result_.records.push_back(std::move(made[i]));
      result_.counts += counts[i];
    }
  }

  void make_at(std::span<const std::uint32_t> points, const RecordFactory& factory) {
    std::vector<RecordSite> sites;
    for (const std::uint32_t i : points)
      sites.push_back(make_site(scene_, points_.surface_point(i), points_.key(i)));
    make(sites, factory);
  }

  /// Gives the records from `first` on their regions.
  void shape(std::size_t first) {
    std::vector<RayCounts> counts(result_.records.size() - first);
    parallel_for(counts.size(), [&](std::size_t i) {
      factory_.shape(result_.records[first + i], rule_, gather_, counts[i]);
    });
    for (const RayCounts& c : counts) result_.counts += c;
  }

  /// Gives the records from `first` on their regions and marks the points that these cover.
  void shape_and_cover(std::size_t first) {
    shape(first);
    std::vector<SurfaceReach> reaches(result_.records.size() - first);
    parallel_for(reaches.size(), [&](std::size_t i) {
      const RadianceRecord& record = result_.records[first + i];
      reaches[i] = reach_over_surface(*charts_, record.site.point, record.region, 1.0);
    });
    for (std::size_t i = 0; i < reaches.size(); ++i)
      points_.cover(result_.records[first + i].region, reaches[i]);
  }

  /// Cheap records on a coarse lattice tell the mean luminance and how many rays a record needs, and
  /// are thrown away; what they found guides the first records, and those of the coarser half of the
  /// lattice guide the others, so that the noise is that of guided records.
  void pilot() {
    std::vector<std::uint32_t> pilots(points_.pilot_count());
    std::iota(pilots.begin(), pilots.end(), 0u);
    gather_.log2_rays = kLog2PilotRays;
    CacheOptions cheap = options_;
    cheap.representation = Representation::kAnalytic;
    cheap.strategy = Strategy::kViewDependent;
    const RecordFactory factory(*charts_, cheap);
    const std::span<const std::uint32_t> all = pilots;
    const std::size_t first = unguided_pilots(all.size());
    make_at(all.first(first), factory);
    make_at(all.subspan(first), factory);
    double sum = 0.0;
    for (const RadianceRecord& record : result_.records) sum += record.estimate.luminance.value;
    rule_.mean_luminance =
        result_.records.empty() ? 1.0 : std::max(sum / static_cast<double>(result_.records.size()), 1e-30);
    gather_.log2_rays = options_.gather_rays > 0 ? log2_rays_for(options_.gather_rays) : rays_for_noise();
    result_.scale = {rule_.mean_luminance, gather_.log2_rays};
    result_.records.clear();
  }

  /// Of all pilots, those that find out where light is for the others.
  [[nodiscard]] std::size_t unguided_pilots(std::size_t all) const { return options_.sends_guided_rays() ? all / 2 : 0; }

  /// Rays that bring a typical record's relative noise down to the accepted error; the joint fit and
  /// the blending of overlapping records lower it further.
  [[nodiscard]] int rays_for_noise() const {
    std::vector<double> noise;
    const std::size_t unguided = unguided_pilots(result_.records.size());
    for (const RadianceRecord& record : std::span(result_.records).subspan(unguided)) {
      noise.push_back(std::sqrt(record.estimate.variance.value) /
                      perceived(record.estimate.luminance.value, rule_.mean_luminance));
    }
    if (noise.empty()) return kFewestLog2Rays;
    const auto middle = noise.begin() + static_cast<std::ptrdiff_t>(noise.size() / 2);
    std::ranges::nth_element(noise, middle);
    return log2_rays_for(kLog2PilotRays, *middle, accepted_noise());
  }

  [[nodiscard]] double accepted_noise() const {
    return (options_.sends_guided_rays() ? kGuidedNoiseShare : kNoiseShare) * accepted_error();
  }

  /// With a wanted number of records the error is unknown: the default's noise is aimed at.
  [[nodiscard]] double accepted_error() const {
    return options_.records > 0 ? CacheOptions{}.error : options_.error;
  }

  /// Gives all records their regions at a threshold and marks the pixels that they cover.
  void spread(double epsilon) {
    rule_.epsilon = epsilon;
    rule_.uniform_radius = std::pow(epsilon, 0.25) * 0.1;
    points_.clear_coverage();
    result_.reaches.clear();
    shape_and_cover(0);
  }

  [[nodiscard]] bool all_covered() const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_.is_open(i)) return false;
    }
    return true;
  }

  /// Covers every visible point at a threshold, keeping the records there are; stops at `limit` records.
  void sweep(double epsilon, PointChooser& chooser,
             std::size_t limit = std::numeric_limits<std::size_t>::max()) {
    spread(epsilon);
    chooser.start();
    while (result_.records.size() < limit && !result_.unfinished) {
      const std::vector<std::uint32_t> chosen =
          chooser.choose(result_.records, limit - result_.records.size());
      if (chosen.empty()) break;
      const std::size_t first = result_.records.size();
      make_at(chosen, factory_);
      for (const std::uint32_t i : chosen) points_.take(i);
      shape_and_cover(first);
      control_.report({"place records", chooser.progress(), result_.records.size(),
                       result_.counts.gather + result_.counts.shadow});
    }
  }

  /// Lowers the threshold step by step, keeping all records, until the wanted number is reached; then
  /// finds the smallest threshold at which these records cover everything. Slivers get their records
  /// on the way, not on top at the end.
  void reach_count() {
    const auto wanted = static_cast<std::size_t>(options_.records);
    double epsilon = threshold(kCoarsestError);
    double covering = 1e4 * epsilon;
    // Should the limit end this sweep, its holes must lie everywhere, not beyond a front.
    OrderedChooser ordered(points_);
    sweep(epsilon, ordered, wanted);
    std::size_t checked = 0;  // records when the samples were last looked at
    for (int step = 0; step < kCountRounds && !result_.unfinished; ++step) {
      if (3 * result_.records.size() >= wanted && result_.records.size() > checked) {
        cover_samples();
        checked = result_.records.size();
      }
      const double ratio =
          static_cast<double>(wanted) / static_cast<double>(std::max<std::size_t>(result_.records.size(), 1));
      if (ratio < 1.03) break;
      // The count grows about as epsilon^-0.46; approach from below, since records are kept.
      covering = epsilon;
      epsilon *= std::pow(std::clamp(0.85 * ratio, 1.08, 5.0), -1.0 / 0.46);
      sweep(epsilon, *chooser_, wanted);
    }
    if (!result_.unfinished && !all_covered()) widen(epsilon, covering);
  }

  /// Bisects for the smallest threshold between two at which the records cover all points.
  void widen(double low, double high) {
    for (int step = 0; step < kWidenSteps; ++step) {
      const double middle = std::sqrt(low * high);
      spread(middle);
      (all_covered() ? high : low) = middle;
    }
    spread(high);
  }

  /// Fills in the reaches of the records that have none yet.
  void reach_widely() {
    static_assert(kWideSupport >= kFitSupport);
    const std::size_t first = result_.reaches.size();
    for (SurfaceReach& reach : reaches_of(*charts_, std::span(result_.records).subspan(first), kWideSupport))
      result_.reaches.push_back(std::move(reach));
  }

  /// Slivers between the points: what no region reaches even when widened gets records.
  void cover_samples() {
    const TileLayout layout = {view_.x0, view_.y0, view_.x1, view_.y1};
    std::vector<std::size_t> tiles(layout.count());
    for (std::size_t i = 0; i < tiles.size(); ++i) tiles[i] = i;
    for (int round = 0; round < kSampleRounds && !tiles.empty() && !result_.unfinished; ++round) {
      reach_widely();
      const RadianceCache cache(charts_, result_.records, result_.reaches, factory_.brdfs());
      std::vector<std::vector<OpenSample>> open(tiles.size());
      std::vector<RayCounts> counts(tiles.size());
      parallel_for(tiles.size(), [&](std::size_t i) {
        open[i] = find_open_samples(scene_, *view_.film, cache, layout, tiles[i], counts[i]);
      });
      std::vector<RecordSite> sites;
      std::vector<std::size_t> again;
      for (std::size_t i = 0; i < tiles.size(); ++i) {
        result_.counts += counts[i];
        if (!open[i].empty()) again.push_back(tiles[i]);
        for (const OpenSample& s : open[i]) {
          sites.push_back(
              make_site(scene_, scene_.surface_point(s.triangle, s.u, s.v, scene_.camera().origin), s.key));
        }
      }
      const std::size_t first = result_.records.size();
      make(sites, factory_);
      shape(first);
      tiles = std::move(again);
    }
  }

  void classify() {
    parallel_for(result_.records.size(), [&](std::size_t i) {
      RadianceRecord& record = result_.records[i];
      // Those of a hybrid cache were classified by the ellipse that they had as Taylor records.
      if (options_.representation != Representation::kHybrid || !record.uses_harmonics())
        record.curvature = classify_site(*charts_, record, options_.max_normal_deviation);
    });
  }

  const Scene& scene_;
  const PlacementView& view_;
  const CacheOptions& options_;
  const RunControl& control_;
  PlacementResult result_;
  std::shared_ptr<const SceneCharts> charts_;
  RecordFactory factory_;
  VisiblePoints points_;
  std::unique_ptr<PointChooser> chooser_;
  GatherOptions gather_;
  GuideField guides_;
  NoiseGoal noise_goal_;
  RegionRule rule_;
};

}  // namespace

int log2_rays_for(int rays) {
  return std::max(kFewestLog2Rays, static_cast<int>(std::bit_width(static_cast<unsigned>(rays - 1))));
}

PlacementResult place_records(const Scene& scene, const PlacementView& view, const CacheOptions& options,
                              int bounces, std::uint64_t seed, const RunControl& control,
                              const EarlierFrames& earlier) {
  return Placement(scene, view, options, bounces, seed, control, earlier).run();
}

}  // namespace vrc
