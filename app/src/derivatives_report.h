// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "shading/derivative_images.h"

namespace vrc {

/// One finished run of `vrc derivatives`, as it is reported.
struct DerivativesReport {
  std::string scene;
  std::string command_line;
  int threads = 0;
  DerivativeOptions options;
  double gradient_scale = 0.0, hessian_scale = 0.0;  ///< Of the PNG files, before --exposure.
  double seconds = 0.0;
  double cpu_seconds = 0.0;
};

/// JSON text; numbers that are not finite become null.
[[nodiscard]] std::string derivatives_json(const DerivativesReport& report, const DerivativeImages& images);

/// A line for each method: errors against the finite differences and what a record costs.
[[nodiscard]] std::string derivatives_table(const DerivativeImages& images);

}  // namespace vrc
