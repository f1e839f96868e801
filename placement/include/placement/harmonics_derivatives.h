// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/jet2.h"
#include "placement/gather.h"
#include "placement/incident_harmonics.h"
#include "transport/brdf_harmonics.h"

namespace vrc {

/// The weights of a BRDF towards the camera (BrdfHarmonics::response) and how they change as the site moves
/// over its surface: by d in its tangent plane to x(d) = x + d - n (d^T S d) / 2, where the normal is
/// n(d) = normalize(n + S d), while the camera stays.
struct MovingWeights {
  /// Row j belongs to coefficient j in world axes; column IncidentHarmonics::kEntries c + k to entry k of
  /// channel c: value, d1, d2, d11, d12, d22 along the tangents of the site.
  Eigen::Matrix<float, Eigen::Dynamic, 3 * IncidentHarmonics::kEntries> coefficients;
};

/// By central differences with steps that turn the lobe by about 0.025 rad: the step of the tables of
/// BrdfHarmonics, between whose entries second derivatives are lost. Errors grow like the square of that
/// angle times the order, and where the camera is less than it above the horizon of the surface.
[[nodiscard]] MovingWeights moving_weights(const BrdfHarmonics& brdf, const RecordSite& site, int order);

/// Outgoing radiance towards the camera with its full derivatives along the surface, by the product rule
/// over incident radiance and weights.
[[nodiscard]] std::array<Jet2, 3> outgoing_radiance(const IncidentHarmonics& incident,
                                                    const MovingWeights& weights);

}  // namespace vrc
