// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "placement/gather.h"
#include "transport/bsdf.h"

namespace vrc {

/// How the columns of the unit square are shared out, in eighths: rays by the cosine or uniform ones
/// first, then the glossy lobes. Cosine rays carry the diffuse part, lobe rays the highlights; all see
/// everything.
struct GatherStrategy {
  enum class Kind { kCosine, kUniform, kLobe };
  Kind kind = Kind::kCosine;
  const Lobe* lobe = nullptr;
  float begin = 0.0f, end = 1.0f;

  bool operator==(const GatherStrategy&) const = default;
};

/// The unit square as directions at a site, by several strategies side by side.
class SamplingSquare {
 public:
  /// `normal` and `to_camera` are unit vectors. The BRDF must outlive the square.
  SamplingSquare(const Bsdf& bsdf, GatherDirections directions, const Vec3& normal, const Vec3& to_camera);

  [[nodiscard]] const Bsdf& bsdf() const { return *bsdf_; }
  [[nodiscard]] const std::vector<GatherStrategy>& strategies() const { return strategies_; }

  [[nodiscard]] V3x16 direction(F16 u1, F16 u2) const;
  /// Of a strategy per solid angle, not multiplied by its share.
  [[nodiscard]] F16 pdf(const GatherStrategy& strategy, const Directions16& d) const;
  /// Of all of them together.
  [[nodiscard]] F16 pdf(const Directions16& d) const;
  /// Where the lobe of a strategy, not a uniform one, makes directions from; not squeezed into its columns.
  [[nodiscard]] SampleInverse inverse(const GatherStrategy& strategy) const;
  [[nodiscard]] const V3x16& normal() const { return normal_; }
  /// The pair of a direction with that of the camera.
  [[nodiscard]] Directions16 with_camera(const V3x16& direction) const {
    return directions(normal_, to_camera_, direction);
  }

 private:
  [[nodiscard]] V3x16 direction(const GatherStrategy& strategy, F16 u1, F16 u2) const;

  const Bsdf* bsdf_;
  std::vector<GatherStrategy> strategies_;
  V3x16 normal_, to_camera_;
};

}  // namespace vrc
