// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mitsuba_properties.h"
#include "transport/material.h"

namespace vrc {

/// What Mitsuba gives to shapes without a BSDF: one-sided diffuse 0.5.
[[nodiscard]] Material default_material();

/// diffuse, phong, roughconductor (GGX), blendbsdf with a constant weight, twosided. The lobes are
/// normalised (`normalize_lobes`); reflectances that add up to more than 1 are a warning.
/// Throws InputError at the element on anything else; when lenient, an unknown BSDF becomes the
/// default material.
[[nodiscard]] Material read_bsdf(const XmlElement& element, MitsubaContext& context);

}  // namespace vrc
