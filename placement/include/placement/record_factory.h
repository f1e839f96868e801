// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "placement/cache_options.h"
#include "placement/record_maker.h"
#include "placement/scene_charts.h"
#include "transport/brdf_harmonics.h"

namespace vrc {

/// Makes records and decides what they hold: radiance towards the camera or incident radiance in
/// spherical harmonics. Const and thread-safe.
class RecordFactory {
 public:
  /// Charts, their scene and options must outlive it. Throws InputError when irradiance is to be cached
  /// and the scene has glossy surfaces.
  /// `brdfs` of an earlier factory with the same options are used again.
  RecordFactory(const SceneCharts& charts, const CacheOptions& options,
                std::shared_ptr<const BrdfHarmonicsSet> brdfs = nullptr);

  /// What must be known to shade with the records' harmonics; null when no record can have any.
  [[nodiscard]] const std::shared_ptr<const BrdfHarmonicsSet>& brdfs() const { return brdfs_; }

  /// Gathers what the strategy and the representation ask for everywhere. Rays towards the camera are guided
  /// by what `guides` holds nearby, and when they turn out too noisy by their own, which then do
  /// not count. A record of a hybrid cache that holds harmonics whatever its region is gathers them alone.
  [[nodiscard]] RadianceRecord make(const RecordSite& site, const GatherOptions& gather,
                                    const NoiseGoal& goal, RayCounts& counts, const GuideField& guides) const;

  /// Gathers again, by 2^log2_rays rays, at a record that was made here. The estimate becomes the mean of
  /// these rays and, if it is to keep them, of its own; those guide the new ones in any case, with `guides`.
  /// Not for records that hold harmonics alone. Of a hybrid cache, harmonics are forgotten.
  void add_rays(RadianceRecord& record, const GatherOptions& gather, int log2_rays, bool keep_own,
                RayCounts& counts, const GuideField& guides) const;

  /// Gives the record its region, decides by the rule of a hybrid cache whether it is to hold spherical
  /// harmonics and gathers them when it does so for the first time.
  void shape(RadianceRecord& record, const RegionRule& rule, const GatherOptions& gather,
             RayCounts& counts) const;

  /// Whether records hold nothing else.
  [[nodiscard]] bool holds_only_harmonics() const {
    return options_.representation == Representation::kHarmonics ||
           options_.representation == Representation::kIrradiance;
  }

 private:
  [[nodiscard]] std::shared_ptr<const RecordHarmonics> gather_harmonics(const RecordSite& site,
                                                                        const GatherOptions& gather,
                                                                        RayCounts& counts,
                                                                        HitDistances& hits) const;
  /// What the BRDF at the site weighs harmonics by, towards the camera: coefficients x channels.
  [[nodiscard]] Eigen::MatrixXf weights_at(const RecordSite& site) const;
  [[nodiscard]] bool resolves_lobes_at(const RecordSite& site) const;
  /// Whether it is an edge so narrow that it gets harmonics, unless its pixels are gathered again.
  [[nodiscard]] bool is_narrow_edge(const RecordSite& site) const;
  /// Whether a record there holds harmonics however small its region is, which is no less than a pixel: its
  /// estimate is that of the harmonics.
  [[nodiscard]] bool surely_needs_harmonics(const RecordSite& site) const;
  [[nodiscard]] HarmonicsReason reason_for(const RadianceRecord& record) const;

  const SceneCharts& charts_;
  const CacheOptions& options_;
  /// Those of the orders that the materials ask for; none when no record can hold harmonics.
  std::vector<std::shared_ptr<const HarmonicsGatherer>> gatherers_;  ///< Per material.
  std::shared_ptr<const BrdfHarmonicsSet> brdfs_;
};

/// Order that resolves a BRDF's sharpest lobe, of Phong exponent N: 3.5 sqrt(N), in [8, 24]. With
/// 2.5 sqrt(N) the truncated rest is still 1e-2 of the radiance's square (docs/decisions/007).
[[nodiscard]] int harmonics_order_for(const Bsdf& bsdf);
/// The largest of a scene.
[[nodiscard]] int harmonics_order_for(const std::vector<Bsdf>& bsdfs);

}  // namespace vrc
