// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/scene_reader.h"
#include "mitsuba_properties.h"

namespace vrc {

/// A perspective <sensor> with its film, filter and sampler: sets camera, film and samples_per_pixel.
/// The size in `options` goes over that of the film, before the field of view is applied. A `to_world`
/// that scales is normalised; one that mirrors gives a mirrored image. Throws InputError at the element.
void read_sensor(const XmlElement& element, const SceneReadOptions& options, MitsubaContext& context,
                 SceneDescription& scene);

/// `max_depth` of an integrator of any type, or of the first one nested in it (aov, moment); `direct`
/// has 2. Its other properties, which say how to estimate, are ignored.
[[nodiscard]] int read_max_depth(const XmlElement& element, MitsubaContext& context);

}  // namespace vrc
