// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/place_records.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_set>

#include "core/hash.h"
#include "core/parallel.h"
#include "open_samples.h"
#include "placement/joint_fit.h"
#include "placement/record_factory.h"
#include "placement/visible_points.h"
#include "point_chooser.h"

namespace vrc {
namespace {

constexpr int kLog2PilotRays = 10;
constexpr double kNoiseLimit = 2.5;             // of the accepted noise: beyond it a record is gathered again
constexpr double kLeastNoise = 1e-9;            // relative: where all is dark there is none, which is known
constexpr std::size_t kRecordsAtOnce = 128;     // at most, where there may be enough soon
constexpr std::size_t kFewestToLearnFrom = 64;  // records, whose noise tells how many rays others need
// Passes over the samples that the points miss: a block of pixels gets at most one record in each, line by
// line a tile. Blocks become smaller, since one record may show many others.
constexpr int kSampleRounds = 11, kSampleRoundsByLine = 24;
constexpr int kSmallestBlock = 2;
constexpr int kCountRounds = 80;  // steps of the search for a wanted number of records
constexpr int kWidenSteps = 6;
// The number of records grows about as epsilon^-kCountPower; less where most lie at edges of any radii.
constexpr double kCountPower = 0.46, kLeastCountPower = 0.2;
constexpr double kCountTolerance = 1.03;
constexpr double kGrowthToLookAgain = 1.25;  // of the records, until the samples are looked at again
constexpr double kCoarsestError = 2.8;       // where that search begins

}  // namespace

class RecordPlacer::Placement {
 public:
  Placement(const Scene& scene, const PlacementView& view, const CacheOptions& options, int bounces,
            std::uint64_t seed, const RunControl& control, const EarlierFrames& earlier)
      : scene_(scene),
        view_(view),
        options_(options),
        control_(control),
        earlier_(earlier.cache != nullptr),
        charts_(earlier.cache != nullptr ? earlier.cache->shared_charts() : make_charts()),
        factory_(*charts_, options_, earlier.cache != nullptr ? earlier.cache->brdfs() : nullptr),
        points_(options.sampler == Sampler::kImage ? pixel_centres(*charts_, view, result_.counts.camera)
                                                   : film_points(*charts_, view, result_.counts.camera)),
        guides_(scene) {
    gather_.bounces = bounces;
    gather_.glossy_glossy = options.glossy_glossy;
    gather_.total_derivative = options.total_derivative;
    gather_.occlusion_aware = options.occlusion_aware;
    gather_.choose_light = options.guided;
    gather_.seed = seed;
    rule_.options = &options_;
    rule_.picture_width = std::max(scene.camera().width, scene.camera().height);
    if (earlier.cache != nullptr) {
      const auto records = earlier.cache->records();
      result_.records.assign(records.begin(), records.end());
      result_.scale = earlier.scale;
    }
    if (!options.overture)
      chooser_ = std::make_unique<LineChooser>(points_);
    else if (options.sampler == Sampler::kImage)
      chooser_ = std::make_unique<OrderedChooser>(points_);
    else
      chooser_ = std::make_unique<FrontChooser>(*charts_, points_);
  }

  bool cover(double error, const std::function<bool()>& enough) {
    const PhaseTimer timer("place records");
    if (noise_ == 0.0 && result_.scale.log2_rays == 0) pilot();
    rule_.mean_luminance = result_.scale.mean_luminance;
    options_.error = result_.scale.error = error;
    set_rays(error);
    if (options_.gather_rays == 0) noise_goal_ = {kNoiseLimit * accepted_noise(error), rule_.mean_luminance};
    if (!result_.records.empty() && !earlier_) add_rays(enough);
    if (options_.records > 0)
      reach_count();
    else
      sweep_until(enough);
    add_time(timer);
    return all_covered();
  }

  [[nodiscard]] double open_share() const {
    std::size_t open = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) open += points_.is_open(i) ? 1 : 0;
    return static_cast<double>(open) / static_cast<double>(std::max<std::size_t>(points_.size(), 1));
  }

  [[nodiscard]] double relative_work(double error) const {
    const double records = std::pow(threshold(options_.error) / threshold(error), kCountPower);
    return records * mean_rays(log2_rays_for_noise(error)) / mean_rays(log2_rays_);
  }

  [[nodiscard]] PlacementResult snapshot() {
    reach_widely();
    PlacementResult copy = result_;
    if (options_.joint_fit) fit_jointly(*charts_, copy.records, copy.reaches, rule_);
    copy.charts = charts_;
    copy.brdfs = factory_.brdfs();
    return copy;
  }

  PlacementResult finish(const std::function<bool()>& enough) {
    const PhaseTimer timer("place records");
    if (options_.records == 0 && !result_.unfinished) cover_samples(enough);
    reach_widely();
    add_time(timer);
    if (options_.joint_fit) {
      PhaseTimer fit_timer("fit records");
      fit_jointly(*charts_, result_.records, result_.reaches, rule_);
      result_.phases.push_back(fit_timer.elapsed());
    }
    classify();
    drop_unused_harmonics();
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

  /// The threshold of eq. 4 at which records and hard pixels together gave 0.3 to 1.6 times a relative error
  /// in measurements (docs/decisions/011).
  static double threshold(double error) {
    const double squared = error * error;
    return squared * std::min(0.06, std::max(32.0 * squared, 0.0128));
  }

  /// `turns` of the records, which count without an overture.
  void make(const std::vector<RecordSite>& sites, std::span<const std::uint32_t> turns,
            const RecordFactory& factory) {
    std::vector<RadianceRecord> made(sites.size());
    std::vector<RayCounts> counts(sites.size());
    parallel_for(sites.size(), [&](std::size_t i) {
      if (!control_.stopped())
        made[i] = factory.make(sites[i], gather_at(sites[i]), noise_goal_, counts[i], guides_);
    });
    if (control_.stopped()) {
      result_.unfinished = true;
      return;
    }
    learn_noise(made);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (made[i].found) guides_.add(made[i].site, made[i].found);
      if (!options_.overture) made[i].turn = turns[i];
      result_.records.push_back(std::move(made[i]));
      result_.counts += counts[i];
    }
  }

  void make_at(std::span<const std::uint32_t> points, const RecordFactory& factory) {
    std::vector<RecordSite> sites;
    std::vector<std::uint32_t> turns;
    for (const std::uint32_t i : points) {
      sites.push_back(make_site(scene_, points_.surface_point(i), points_.key(i)));
      turns.push_back(points_.turn(i));
    }
    make(sites, turns, factory);
  }

  /// Gives the records from `first` on their regions.
  void shape(std::size_t first) {
    std::vector<RayCounts> counts(result_.records.size() - first);
    parallel_for(counts.size(), [&](std::size_t i) {
      factory_.shape(result_.records[first + i], rule_, gather_at(result_.records[first + i].site),
                     counts[i]);
    });
    for (const RayCounts& c : counts) result_.counts += c;
  }

  /// Gives the records from `first` on their regions and marks the points that these cover.
  void shape_and_cover(std::size_t first) {
    shape(first);
    std::vector<SurfaceReach> reaches(result_.records.size() - first);
    parallel_for(reaches.size(), [&](std::size_t i) {
      const RadianceRecord& record = result_.records[first + i];
      reaches[i] = reach_over_surface(*charts_, record.site.point, turned_widest(record.region), 1.0);
    });
    for (std::size_t i = 0; i < reaches.size(); ++i)
      points_.cover(result_.records[first + i].region, reaches[i], result_.records[first + i].turn);
  }

  /// Cheap records on a coarse lattice tell the mean luminance and how many rays a record needs, and
  /// are thrown away; what they found guides the first records, and those of the coarser half of the
  /// lattice guide the others, so that the noise is that of guided records.
  void pilot() {
    std::vector<std::uint32_t> pilots(points_.pilot_count());
    std::iota(pilots.begin(), pilots.end(), 0u);
    log2_rays_ = kLog2PilotRays;
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
    noise_ = typical_noise();
    result_.scale.mean_luminance = rule_.mean_luminance;
    result_.records.clear();
  }

  /// Of all pilots, those that find out where light is for the others.
  [[nodiscard]] std::size_t unguided_pilots(std::size_t all) const { return options_.guided ? all / 2 : 0; }

  /// The more gathers there are to guide new ones, the fewer rays these need: their number follows the noise
  /// of the latest records.
  void learn_noise(std::span<const RadianceRecord> made) {
    if (noise_ == 0.0 || options_.gather_rays > 0 || !options_.guided) return;
    for (const RadianceRecord& record : made) {
      if (!record.found) continue;
      const double doublings = std::log2(static_cast<double>(record.rays)) - kLog2PilotRays;
      recent_noise_.push_back(relative_noise(record) * std::exp2(0.5 * kVarianceConvergence * doublings));
    }
    if (recent_noise_.size() < kFewestToLearnFrom) return;
    noise_ = std::max(middle_of(recent_noise_), kLeastNoise);
    recent_noise_.clear();
    set_rays(options_.error);
  }

  void set_rays(double error) {
    log2_rays_ = log2_rays_for_noise(error);
    result_.scale.log2_rays = log2_rays_;
  }

  [[nodiscard]] double relative_noise(const RadianceRecord& record) const {
    return std::sqrt(record.estimate.variance.value) /
           perceived(record.estimate.luminance.value, rule_.mean_luminance);
  }

  static double middle_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
  }

  /// Relative noise of a typical record of the guided pilots; 0: there is none.
  [[nodiscard]] double typical_noise() const {
    std::vector<double> noise;
    const std::size_t unguided = unguided_pilots(result_.records.size());
    for (const RadianceRecord& record : std::span(result_.records).subspan(unguided))
      noise.push_back(relative_noise(record));
    return noise.empty() ? 0.0 : middle_of(noise);
  }

  /// Rays that bring a typical record's noise down to the accepted error; the joint fit and the blending of
  /// overlapping records lower it further.
  [[nodiscard]] double log2_rays_for_noise(double error) const {
    if (options_.gather_rays > 0) return log2_mean_rays(options_.gather_rays);
    if (noise_ == 0.0) return std::max(result_.scale.log2_rays, static_cast<double>(kFewestLog2Rays));
    return log2_rays_for(kLog2PilotRays, noise_, accepted_noise(error));
  }

  /// A power of two below or above `log2_rays`, at random by the site.
  [[nodiscard]] int log2_rays_at(const RecordSite& site, double log2_rays) const {
    const double dither = static_cast<double>(hash(gather_.seed, site.key, 0xd17eu) >> 11) * 0x1p-53;
    return static_cast<int>(std::floor(log2_rays + dither));
  }
  /// Of the sites' mean.
  [[nodiscard]] static double mean_rays(double log2_rays) {
    const double below = std::floor(log2_rays);
    return std::exp2(below) * (1.0 + log2_rays - below);
  }
  /// What has this mean.
  [[nodiscard]] static double log2_mean_rays(int rays) {
    const int below = std::bit_width(static_cast<unsigned>(rays)) - 1;
    return std::max(below + std::ldexp(rays, -below) - 1.0, static_cast<double>(kFewestLog2Rays));
  }
  [[nodiscard]] GatherOptions gather_at(const RecordSite& site) const {
    GatherOptions options = gather_;
    options.log2_rays = log2_rays_at(site, log2_rays_);
    return options;
  }

  /// log2 of the rays that the noise goal asks for, where a record misses it; else 0.
  [[nodiscard]] int log2_rays_against_noise(const RadianceRecord& record) const {
    const double deviation = std::sqrt(record.estimate.variance.value);
    const double wanted =
        noise_goal_.relative * perceived(record.estimate.luminance.value, rule_.mean_luminance);
    if (noise_goal_.relative == 0.0 || deviation <= wanted) return 0;
    return static_cast<int>(
        std::lround(log2_rays_for(std::log2(static_cast<double>(record.rays)), deviation, wanted)));
  }

  /// Gives all records as many rays as new ones have, and more to those that miss the noise goal. Those of
  /// the first round, whose rays had little to guide them, do not keep these then. Stops when `enough` says
  /// so.
  void add_rays(const std::function<bool()>& enough) {
    if (factory_.holds_only_harmonics()) return;
    badly_guided_.resize(result_.records.size(), badly_guided_.empty() && options_.guided ? 1 : 0);
    const std::size_t count = result_.records.size(), at_once = enough ? kRecordsAtOnce : count;
    for (std::size_t first = 0; first < count && !(enough && enough()); first += at_once)
      add_rays(first, std::min(first + at_once, count));
  }

  void add_rays(std::size_t first, std::size_t end) {
    std::vector<RayCounts> counts(end - first);
    parallel_for(counts.size(), [&](std::size_t k) {
      const std::size_t i = first + k;
      RadianceRecord& record = result_.records[i];
      const auto has = static_cast<int>(std::lround(std::log2(static_cast<double>(record.rays))));
      const int doublings = std::max(log2_rays_at(record.site, log2_rays_) - has, 0);
      const bool keep_own = badly_guided_[i] == 0;
      if (control_.stopped()) return;
      if (doublings > 0) {
        const double wanted =
            static_cast<double>(record.rays) * (std::exp2(doublings) - (keep_own ? 1.0 : 0.0));
        const int log2_rays = std::min(static_cast<int>(std::lround(std::log2(wanted))), kMostLog2Rays);
        factory_.add_rays(record, gather_, log2_rays, keep_own, counts[k], guides_);
        badly_guided_[i] = 0;
      }
      if (const int more = log2_rays_against_noise(record); (std::uint64_t{1} << more) > record.rays)
        factory_.add_rays(record, gather_, more, false, counts[k], guides_);
    });
    for (const RayCounts& c : counts) result_.counts += c;
  }

  void add_time(const PhaseTimer& timer) {
    const PhaseTime time = timer.elapsed();
    if (result_.phases.empty() || result_.phases.back().name != time.name) {
      result_.phases.push_back(time);
      return;
    }
    result_.phases.back().seconds += time.seconds;
    result_.phases.back().cpu_seconds += time.cpu_seconds;
  }

  /// A record's own, relative.
  [[nodiscard]] double accepted_noise(double error) const {
    return options_.records > 0 ? kErrorWithNumber : error;
  }

  /// Gives all records their regions at a threshold and marks the pixels that they cover.
  void spread(double epsilon) {
    rule_.epsilon = epsilon;
    rule_.uniform_radius = std::pow(epsilon, 0.25) * 0.1;
    points_.clear_coverage();
    result_.reaches.clear();
    shape_and_cover(0);
  }

  [[nodiscard]] bool all_covered() const { return open_share() == 0.0; }

  /// Covers every visible point at a threshold, keeping the records there are; stops at `limit` records, or
  /// when `enough` says so.
  void sweep(double epsilon, PointChooser& chooser,
             std::size_t limit = std::numeric_limits<std::size_t>::max(),
             const std::function<bool()>& enough = {}) {
    const std::size_t at_once = enough ? kRecordsAtOnce : limit;
    spread(epsilon);
    chooser.start();
    while (result_.records.size() < limit && !result_.unfinished && !(enough && enough())) {
      const std::vector<std::uint32_t> chosen =
          chooser.choose(result_.records, std::min(limit - result_.records.size(), at_once));
      if (chosen.empty()) break;
      const std::size_t first = result_.records.size();
      make_at(chosen, factory_);
      for (const std::uint32_t i : chosen) points_.take(i);
      shape_and_cover(first);
      const double progress =
          options_.records > 0 ? std::min(1.0, static_cast<double>(result_.records.size()) / options_.records)
                               : chooser.progress();
      control_.report(
          {"place records", progress, result_.records.size(), result_.counts.gather + result_.counts.shadow});
    }
  }

  /// Covers every visible point for the accepted error; stops when `enough` says so.
  void sweep_until(const std::function<bool()>& enough) {
    constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
    // What is left open then should lie everywhere, not beyond a front.
    OrderedChooser ordered(points_);
    sweep(threshold(options_.error), enough ? static_cast<PointChooser&>(ordered) : *chooser_, kNoLimit,
          enough);
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
    sweep(epsilon, options_.overture ? static_cast<PointChooser&>(ordered) : *chooser_, wanted);
    double power = kCountPower;
    double looked = static_cast<double>(wanted) / (3.0 * kGrowthToLookAgain);  // the records there were then
    const auto count = [&] { return static_cast<double>(std::max<std::size_t>(result_.records.size(), 1)); };
    for (int step = 0; step < kCountRounds && !result_.unfinished; ++step) {
      if (static_cast<double>(wanted) < kCountTolerance * count()) break;
      if (count() >= kGrowthToLookAgain * looked) {
        cover_samples();
        looked = count();
      }
      // Approach from below, since records are kept.
      const double before = count();
      covering = epsilon;
      epsilon *= std::pow(std::clamp(0.85 * static_cast<double>(wanted) / before, 1.08, 5.0), -1.0 / power);
      sweep(epsilon, *chooser_, wanted);
      power = std::clamp(std::log(count() / before) / std::log(covering / epsilon), kLeastCountPower,
                         kCountPower);
    }
    if (!result_.unfinished && !all_covered()) widen(epsilon, covering);
    if (!result_.unfinished) cover_samples();
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

  /// Slivers between the points: what no region reaches even when widened gets records, until there are
  /// enough.
  void cover_samples(const std::function<bool()>& enough = {}) {
    const TileLayout layout = {view_.x0, view_.y0, view_.x1, view_.y1};
    std::vector<std::size_t> tiles(layout.count());
    std::iota(tiles.begin(), tiles.end(), std::size_t{0});
    std::vector<Tile> still(layout.count());
    // A record that was moved out of a crease or holds harmonics of another normal may leave its sample open.
    std::unordered_set<std::uint64_t> tried;
    const int further =
        options_.supersample_edges ? further_edge_samples(view_.film->samples_per_pixel()) : 0;
    const int rounds = options_.overture ? kSampleRounds : kSampleRoundsByLine;
    for (int round = 0; round < rounds && !tiles.empty() && !result_.unfinished && !(enough && enough());
         ++round) {
      reach_widely();
      const RadianceCache cache(charts_, result_.records, result_.reaches, factory_.brdfs());
      std::vector<std::vector<OpenSample>> open(tiles.size());
      std::vector<RayCounts> counts(tiles.size());
      parallel_for(tiles.size(), [&](std::size_t i) {
        const std::vector<Pixel> pixels = pixels_of(layout, tiles[i]);
        Tile& samples = still[tiles[i]];
        samples = round == 0 ? find_open_samples(scene_, *view_.film, cache, pixels, further, counts[i])
                             : still_open(cache, samples);
        open[i] =
            choose_open_samples(samples, pixels.front(), std::max(kTileSize >> round, kSmallestBlock), tried);
      });
      std::vector<RecordSite> sites;
      std::vector<std::uint32_t> turns;
      std::vector<std::size_t> again;
      for (std::size_t i = 0; i < tiles.size(); ++i) {
        result_.counts += counts[i];
        if (!open[i].empty()) again.push_back(tiles[i]);
        // Line by line the first one's record may show the others.
        if (!options_.overture && open[i].size() > 1) open[i].resize(1);
        for (const OpenSample& s : open[i]) {
          sites.push_back(
              make_site(scene_, scene_.surface_point(s.triangle, s.u, s.v, scene_.camera().origin), s.key));
          turns.push_back(s.turn);
          tried.insert(s.key);
        }
      }
      const std::size_t first = result_.records.size();
      make(sites, turns, factory_);
      shape(first);
      tiles = std::move(again);
    }
  }

  void classify() {
    if (!options_.classify_sites) return;
    const PhaseTimer timer("classify sites");
    parallel_for(result_.records.size(), [&](std::size_t i) {
      RadianceRecord& record = result_.records[i];
      // Those of a hybrid cache were classified by the ellipse that they had as Taylor records.
      if (options_.representation != Representation::kHybrid || !record.uses_harmonics())
        record.curvature = classify_site(*charts_, record, options_.turning_angle());
    });
    add_time(timer);
  }

  /// Of records whose regions were larger for a coarser error.
  void drop_unused_harmonics() {
    if (options_.representation != Representation::kHybrid || options_.strategy != Strategy::kViewDependent)
      return;
    for (RadianceRecord& record : result_.records) {
      if (!record.uses_harmonics()) record.harmonics.reset();
    }
  }

  const Scene& scene_;
  const PlacementView& view_;
  CacheOptions options_;
  const RunControl& control_;
  bool earlier_;  // there are records of other frames
  PlacementResult result_;
  std::shared_ptr<const SceneCharts> charts_;
  RecordFactory factory_;
  VisiblePoints points_;
  std::unique_ptr<PointChooser> chooser_;
  GatherOptions gather_;
  GuideField guides_;
  std::vector<double> recent_noise_;  // of records with 2^kLog2PilotRays rays
  NoiseGoal noise_goal_;
  double log2_rays_ = 0.0;                  // of records, on average
  std::vector<std::uint8_t> badly_guided_;  // records of the first round that have no others' rays yet
  double noise_ = 0.0;                      // relative, of a typical record with kLog2PilotRays
  RegionRule rule_;
};

RecordPlacer::RecordPlacer(const Scene& scene, const PlacementView& view, const CacheOptions& options,
                           int bounces, std::uint64_t seed, const RunControl& control,
                           const EarlierFrames& earlier)
    : placement_(std::make_unique<Placement>(scene, view, options, bounces, seed, control, earlier)) {}

RecordPlacer::~RecordPlacer() = default;

bool RecordPlacer::cover(double error, const std::function<bool()>& enough) {
  return placement_->cover(error, enough);
}
double RecordPlacer::open_share() const { return placement_->open_share(); }
double RecordPlacer::relative_work(double error) const { return placement_->relative_work(error); }
PlacementResult RecordPlacer::snapshot() { return placement_->snapshot(); }
PlacementResult RecordPlacer::finish(const std::function<bool()>& enough) {
  return placement_->finish(enough);
}

RadianceCache cache_of(PlacementResult&& placed) {
  return {std::move(placed.charts), std::move(placed.records), placed.reaches, std::move(placed.brdfs)};
}

int log2_rays_for(int rays) {
  return std::max(kFewestLog2Rays, static_cast<int>(std::bit_width(static_cast<unsigned>(rays - 1))));
}

PlacementResult place_records(const Scene& scene, const PlacementView& view, const CacheOptions& options,
                              int bounces, std::uint64_t seed, const RunControl& control,
                              const EarlierFrames& earlier) {
  RecordPlacer placer(scene, view, options, bounces, seed, control, earlier);
  placer.cover(options.error);
  return placer.finish();
}

}  // namespace vrc
