// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/types.h"
#include "mitsuba_element.h"

namespace vrc {

// The values that elements of a scene hold. All throw InputError at the element when the text is not
// a finite number, or not as many numbers as the element needs.

/// `value` of <float> and <integer>.
[[nodiscard]] double parse_number(const XmlElement& element);

/// <vector> and <point>: three numbers in `value`, or x, y and z, which are `fallback` when absent.
[[nodiscard]] Vec3 parse_vector(const XmlElement& element, double fallback = 0.0);

/// <rgb>, <srgb>, <spectrum> and <float>: three numbers or one for all; #rrggbb and the numbers of
/// <srgb> are gamma-encoded sRGB, all others linear. Never negative. <spectrum> takes one number only.
[[nodiscard]] Rgb parse_color(const XmlElement& element);

/// <transform>: its operations in order, each applied after (multiplied from the left of) those before
/// it. The result is affine and invertible.
[[nodiscard]] Mat4 parse_transform(const XmlElement& element);

}  // namespace vrc
