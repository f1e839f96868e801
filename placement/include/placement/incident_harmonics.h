// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "placement/gather.h"
#include "sh/basis.h"
#include "sh/derivatives.h"

namespace vrc {

/// Incident radiance around a point in real spherical harmonics, and how it changes as the point moves
/// over its surface: the SH vector Lambda_i of [Zhao 4.2] with its gradients and Hessians (4.3.3).
struct IncidentHarmonics {
  static constexpr int kEntries = 6;  ///< Per channel: value, d1, d2, d11, d12, d22.
  /// Column j belongs to coefficient j in world axes; row kEntries c + k to entry k of channel c.
  /// Derivatives are along the tangent and bitangent of the record's frame, the surface bending away
  /// from them as `followed_shape_operator` says.
  Eigen::Matrix<float, 3 * kEntries, Eigen::Dynamic> coefficients;

  [[nodiscard]] int count() const { return static_cast<int>(coefficients.cols()); }
};

/// Projects gathers onto spherical harmonics of one order. Const and thread-safe.
class HarmonicsGatherer {
 public:
  /// 0 <= order <= sh::kMaxFrameOrder.
  explicit HarmonicsGatherer(int order);

  [[nodiscard]] int order() const { return order_; }

  /// Sums over the rays of a gather [Zhao eq. 7, as an integral over surfaces]. Fills in `hits`.
  ///
  /// With p = l + 1 and the irregular solid harmonics, whose derivatives are sums of those of the next
  /// band (sh::RaisingOperators A), derivatives of Y_lm(r / |r|) need no basis but Y itself up to order + 2:
  ///   d_a Y = (p r_a Y + A_a Y) / |r|,  d_ab Y = ((p delta_ab + p (p - 2) r_a r_b) Y
  ///                                      + p (r_a A_b + r_b A_a) Y + A_a A_b Y) / r^2.
  [[nodiscard]] IncidentHarmonics gather(const Scene& scene, const RecordSite& site,
                                         const GatherOptions& options, RayCounts& counts,
                                         HitDistances& hits) const;

 private:
  struct Moments;
  /// `s`: the shape operator in the record's frame.
  [[nodiscard]] IncidentHarmonics finish(const Moments& moments, const Frame& frame, const Mat2& s,
                                         double rays) const;

  int order_;
  sh::Basis basis_;  ///< Of order + 2.
  sh::RaisingOperators raise_, raise_again_;
};

/// Outgoing radiance from the weights of a BRDF (BrdfHarmonics::response: coefficients x channels), with
/// its derivatives while the weights stay fixed.
[[nodiscard]] std::array<Jet2, 3> outgoing_radiance(const IncidentHarmonics& incident,
                                                    const Eigen::Ref<const Eigen::MatrixXf>& weights);

}  // namespace vrc
