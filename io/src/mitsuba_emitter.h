// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mitsuba_properties.h"
#include "transport/scene_description.h"

namespace vrc {

/// Adds an <emitter> that stands by itself: point, directional or constant. Throws InputError at the
/// element; when lenient, emitters of other types are skipped.
void add_emitter(const XmlElement& element, MitsubaContext& context, SceneDescription& scene);

}  // namespace vrc
