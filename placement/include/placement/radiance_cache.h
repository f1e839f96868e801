// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/simd.h"
#include "geometry/region_index.h"
#include "placement/record.h"
#include "placement/scene_charts.h"
#include "transport/brdf_harmonics.h"

namespace vrc {

/// A record in single precision, its derivatives along the axes of its region, for sixteen-wide use.
struct PackedRecord {
  Vec3f center, normal;
  Vec3f scaled1, scaled2, scaled_normal;  ///< Axes divided by their radii.
  float radius1, radius2;
  float cos_max_deviation, cos_widest_deviation;
  bool split_sphere;
  float inverse_deviation, inverse_widest;  ///< Of the region.
  float reach;                              ///< Largest radius.
  float value[3], g1[3], g2[3], h11[3], h12[3], h22[3];
  /// Whether it knows how radiance changes with the normal. If so, derivatives along the axes are those with
  /// the normal of the record, and there are others:
  bool tilts = false;
  float tan_max_deviation;
  Vec3f tangent, bitangent;
  float n1[3], n2[3], x11[3], x12[3], x21[3], x22[3], m11[3], m12[3], m22[3];  ///< TiltingJet's.
  const IncidentHarmonics* harmonics = nullptr;  ///< If the record uses them; what they need beside:
  float in_frame[2][2];                          ///< The half axes in the frame of their derivatives.
  float gradient_factor, hessian_factor;
  float variance;      ///< Of the gathered luminance, with the record's misfit.
  std::uint32_t turn;  ///< Of the record.
};

[[nodiscard]] PackedRecord pack(const RadianceRecord& record);

/// Position of sixteen points relative to a record: offsets in units of the radii, and its weight.
struct Coverage16 {
  F16 a, b;        ///< Along the two axes.
  F16 m1{}, m2{};  ///< What the normal turns, in the record's frame, if that tilts: n + m, normalised.
  F16 weight;      ///< As `weight(ValidRegion)`, 0 where the record does not apply.
};

/// [Zhao eq. 14-15] with the joint distance, in the lanes where the record applies, the ellipsoid
/// widened `support` times.
[[nodiscard]] Coverage16 coverage(const PackedRecord& record, const V3x16& x, const V3x16& n, I16 applies,
                                  float support, Deviation deviation = Deviation::kAccepted);

/// Where a record's polynomial is taken for points that lie farther from it: offsets of at most `most` radii
/// and normals of at most as many theta_max, in the same directions, with the same weight.
[[nodiscard]] Coverage16 drawn_in(const PackedRecord& record, const Coverage16& c, float most);

/// The Taylor polynomial of [Zhao eq. 13], in the displacement and in what the normal turns.
[[nodiscard]] V3x16 extrapolate(const PackedRecord& record, const Coverage16& c, int order);

/// The same of the coefficients of a record with harmonics, and what a BRDF reflects of the result: `weights`
/// are BrdfHarmonics::response, for all lanes.
[[nodiscard]] V3x16 extrapolate(const PackedRecord& record, const Eigen::MatrixXf& weights,
                                const Coverage16& c, int order);

/// Records registered in all charts that they reach over the surface, and looked up there. Immutable.
/// The charts and their scene must outlive look-ups of points.
class RadianceCache {
 public:
  /// A record in one chart.
  struct Footprint {
    std::uint32_t record = 0;
    std::int32_t patch = 0;
    float low[2], high[2];         ///< Box in the chart's (u, v).
    std::uint32_t first_slot = 0;  ///< Hash slots of the triangles that the record reaches;
    std::uint32_t slot_mask = 0;   ///< 0: all of the patch.
  };

  /// `reaches` are those of the records with the largest support that they are used with. Records of
  /// spherical harmonics need `brdfs`.
  RadianceCache(std::shared_ptr<const SceneCharts> charts, std::vector<RadianceRecord> records,
                std::span<const SurfaceReach> reaches,
                std::shared_ptr<const BrdfHarmonicsSet> brdfs = nullptr);

  [[nodiscard]] const SceneCharts& charts() const { return *charts_; }
  [[nodiscard]] const std::shared_ptr<const SceneCharts>& shared_charts() const { return charts_; }
  [[nodiscard]] std::span<const RadianceRecord> records() const { return records_; }
  [[nodiscard]] const std::shared_ptr<const BrdfHarmonicsSet>& brdfs() const { return brdfs_; }
  [[nodiscard]] std::span<const PackedRecord> packed() const { return packed_; }
  /// By records, and for one record by patches.
  [[nodiscard]] std::span<const Footprint> footprints() const { return footprints_; }

  /// Appends the indices of all footprints in a patch that meet a box there, in rising order.
  void find(std::uint32_t patch, const Vec2& low, const Vec2& high,
            std::vector<std::uint32_t>& result) const {
    index_->find(patch, low, high, result);
  }

  /// Lanes whose point, at `at` in the charts and on `triangle`, the record of a footprint reaches.
  [[nodiscard]] I16 reaches(const Footprint& f, const ChartPoint16& at, I16 triangle) const {
    I16 inside = (at.patch == f.patch) & (at.u >= f.low[0]) & (at.u <= f.high[0]) & (at.v >= f.low[1]) &
                 (at.v <= f.high[1]);
    return f.slot_mask == 0 || !any(inside) ? inside : inside & on_reached_triangle(f, inside, triangle);
  }

 private:
  [[nodiscard]] I16 on_reached_triangle(const Footprint& f, I16 active, I16 triangle) const;

  std::shared_ptr<const SceneCharts> charts_;
  std::vector<RadianceRecord> records_;
  std::shared_ptr<const BrdfHarmonicsSet> brdfs_;
  std::vector<PackedRecord> packed_;
  std::vector<Footprint> footprints_;
  std::vector<std::uint32_t> slots_;
  std::unique_ptr<const RegionIndex> index_;
};

}  // namespace vrc
