// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gather_rays.h"
#include "hit_mesh.h"

namespace vrc {

/// What the estimate with fixed hits lacks: as the record moves by d, silhouettes of near surfaces move
/// over far ones, and the strip of the far surface between its fixed border and the silhouette is
/// uncovered or hidden.
///
/// A point q of the ray along w through the silhouette, at inverse distance s, is seen from the moved
/// record in the direction of w - s d. The strip is swept by 1/b > 1/s > 1/a, b the far and a the near
/// surface's inverse distance, and det[w - s d, -d, dw] = d . (w x dw) exactly, so with the silhouette's
/// normal nu (towards the far side, its length the silhouette's) the strip holds
///   (d . nu) L_far  integral over s from b to a of  f cos(d) / |w - s d|^3:
/// to second order  L_far f cos (a - b) (d . nu) (1 + d . g), where g is the log-gradient of
/// f cos / |w - s d|^3 at the mean s = (a + b) / 2, since log-gradients are linear in s. It is that of
/// `shape_jet` / |r|^4 at r = w / s. The radiance of the far surface towards x adds its own log-gradient,
/// and d has the normal part -n d^T S d / 2 where the record's surface bends.
///
/// The silhouettes are found between neighbours of a mesh [HitMesh] whose hits lie on the same side of each
/// other's tangent planes, once for every strategy, with the balance heuristic's weights.
/// Returns sums that count like those of the rays: their mean is the sum over all rays divided by
/// `rays.ray_count()`. The value is 0; the sixteen partial sums get runs of neighbouring pieces. The sum's
/// bias falls with the size of the cells: unlike the rays' own mean it depends on their number.
template <template <typename> typename Jet>
[[nodiscard]] RgbSum16<Jet> silhouette_derivatives(const HitGrid& grid, const GatherRays& rays);

}  // namespace vrc
