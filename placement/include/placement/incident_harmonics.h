// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/simd.h"
#include "placement/gather.h"
#include "sh/coordinate_operators.h"
#include "sh/scattered_sums.h"

namespace vrc {

/// Incident radiance around a point in real spherical harmonics, and how it changes as the point moves
/// over its surface: the SH vector Lambda_i of [Zhao 4.2] with its gradients and Hessians (4.3.3).
class IncidentHarmonics {
 public:
  static constexpr int kEntries = 6;  ///< Per channel: value, d1, d2, d11, d12, d22.
  /// Column j belongs to coefficient j in world axes, row kEntries c + k to entry k of channel c. Derivatives
  /// are along the tangent and bitangent of the record's frame, the surface bending away from them as
  /// `followed_shape_operator` says.
  using Coefficients = Eigen::Matrix<float, 3 * kEntries, Eigen::Dynamic>;

  IncidentHarmonics() = default;
  /// Rounds every row to 16 bits for its largest coefficient: sums lose about 1e-4 of the radiance.
  explicit IncidentHarmonics(const Coefficients& coefficients);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] Coefficients coefficients() const;
  /// The sums over all coefficients of channel c, times `count` weights.
  [[nodiscard]] Eigen::Matrix<float, kEntries, 1> weighted(int c, const float* weights) const;

 private:
  /// In `rounded_`, of coefficient j of an entry: sixteen of one entry of a channel, then of its next one.
  [[nodiscard]] std::size_t place(int entry, int j) const;

  int count_ = 0;
  std::array<float, 3 * kEntries> scale_{};
  std::vector<std::int16_t> rounded_;
};

/// Projects gathers onto spherical harmonics of one order. Const and thread-safe.
class HarmonicsGatherer {
 public:
  /// 0 <= order <= sh::kMaxFrameOrder.
  explicit HarmonicsGatherer(int order);

  [[nodiscard]] int order() const { return order_; }

  /// Two differences of the means over one half of the rays and the other, halved: of the luminance of the
  /// values, in coefficients. The square of what they reflect is the variance of what the values reflect.
  using NoiseSums = Eigen::Matrix<float, Eigen::Dynamic, 2>;

  /// Sums over the rays of a gather [Zhao eq. 7, as an integral over surfaces]. Fills in `hits` and, unless
  /// null, `noise`.
  ///
  /// With Y(r / |r|) differentiated by sh::CoordinateOperators (D, and X for the direction), derivatives need
  /// no sums but those of Y itself up to order + 2: d_a Y = D_a Y / |r|, d_ab Y = D_a (D_b - X_b) Y / r^2.
  [[nodiscard]] IncidentHarmonics gather(const Scene& scene, const RecordSite& site,
                                         const GatherOptions& options, RayCounts& counts, HitDistances& hits,
                                         NoiseSums* noise = nullptr) const;

 private:
  class Moments;
  /// `s`: the shape operator in the record's frame.
  [[nodiscard]] IncidentHarmonics finish(const Moments& moments, const Frame& frame, const Mat2& s,
                                         double rays) const;

  int order_;
  sh::ScatteredSums sums_;                ///< Of order + 2.
  sh::CoordinateOperators once_, twice_;  ///< Of order and order + 1.
};

/// Outgoing radiance from the weights of a BRDF (BrdfHarmonics::response: coefficients x channels), with
/// its derivatives while the weights stay fixed.
[[nodiscard]] std::array<Jet2, 3> outgoing_radiance(const IncidentHarmonics& incident,
                                                    const Eigen::Ref<const Eigen::MatrixXf>& weights);

}  // namespace vrc
