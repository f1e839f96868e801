// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/types.h"

namespace vrc {

/// Complex index of refraction, per linear RGB channel, against vacuum.
struct Conductor {
  std::string_view name;  ///< Chemical symbol, as in Mitsuba.
  float eta[3];
  float k[3];
};

/// The metal of that name, or nothing when it is not in the table.
[[nodiscard]] std::optional<Conductor> find_conductor(std::string_view name);

/// "Ag, Al, ...", for messages.
[[nodiscard]] std::string conductor_names();

}  // namespace vrc
