// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "placement/cache_options.h"
#include "placement/gather.h"
#include "placement/incident_harmonics.h"

namespace vrc {

/// Irradiance at a point with the derivatives that irradiance caching interpolates.
struct IrradianceEstimate {
  std::array<Jet2, 3> irradiance;  ///< Per channel; translation in the site's frame.
  /// dE / dn: a surface there with the normal m receives E + rotation . (m - n). World, tangent.
  std::array<Vec3, 3> rotation;
  HitDistances hits;
};

/// Gathers about 2^options.log2_rays cosine-distributed rays, one in each cell of the hemisphere, against
/// the radiance that reaches the point; reflection at the hits counts as diffuse in the derivatives.
///
/// kTriangles spans triangles between the hits of neighbouring cells of a square grid; each shines with
/// the radiance of its farthest corner, so that a silhouette moves with the near surface. Form factors
/// of edges, with r and q = r + e to their ends, c = r x q, a = n x e, g = n . c (r and q move with -x):
///   I1 = angle(r, q) / |c|,  I2 = (e.q/q^2 - e.r/r^2 + e^2 I1) / (2 c^2),
///   J2 = (1/2 (1/r^2 - 1/q^2) - (e.r) I2) / e^2,
///   I3 = (e.q/q^4 - e.r/r^4 + 3 e^2 I2) / (4 c^2),  J3 = (1/4 (1/r^4 - 1/q^4) - (e.r) I3) / e^2,
///   K3 = (I2 - r^2 I3 - 2 (e.r) J3) / e^2,  b = I2 r + J2 e,
///   F = sum g I1 / 2 pi,  grad F = sum (I1 a + 2 g b) / 2 pi,
///   H F = sum (a b^T + b a^T + g (4 (I3 r r^T + J3 (r e^T + e r^T) + K3 e e^T) - I2 Id)) / pi.
[[nodiscard]] IrradianceEstimate gather_irradiance(const Scene& scene, const RecordSite& site,
                                                   const GatherOptions& options, IrradianceDerivatives kind,
                                                   RayCounts& counts);

/// The harmonics of order 1 from which a Lambert lobe makes exactly that irradiance, as the normal and the
/// position change.
[[nodiscard]] IncidentHarmonics as_harmonics(const IrradianceEstimate& estimate, const Vec3& normal);

}  // namespace vrc
