// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "core/central_differences.h"
#include "core/jet2.h"
#include "placement/gather.h"

namespace vrc {

/// The site on the same smooth region whose projection to the tangent plane of `site` is displaced by `d`;
/// it has the same key. Nothing where the region ends, its other side is seen or another surface lies
/// less than |d| above it.
[[nodiscard]] std::optional<RecordSite> displaced_site(const Scene& scene, const RecordSite& site,
                                                       const Vec2& d);

/// The sites for central differences along the tangents of the first one.
struct SurfaceStencil {
  double step;  ///< [length]
  StencilValues<RecordSite> sites;
};

/// Nothing where one of the sites is missing.
[[nodiscard]] std::optional<SurfaceStencil> surface_stencil(const Scene& scene, const RecordSite& site,
                                                            double step);

/// A scalar of sites with its derivatives along the surface. With the same random numbers at all sites,
/// as their common key gives them to gathers, most of the noise cancels.
[[nodiscard]] Jet2 differentiate(const SurfaceStencil& stencil,
                                 const std::function<double(const RecordSite&)>& f);

/// Richardson's extrapolation of differences by a step and by its double: without the error of second order.
/// The value is the narrow step's.
[[nodiscard]] Jet2 richardson(const Jet2& narrow, const Jet2& wide);

}  // namespace vrc
