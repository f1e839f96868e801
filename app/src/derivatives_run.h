// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "derivatives_report.h"
#include "scene_arguments.h"
#include "shading/derivative_images.h"

namespace vrc {

inline constexpr int kMostDerivativeRays = 1 << 20;

/// What the user asked `vrc derivatives` to do.
struct DerivativesArguments : SceneArguments {
  std::string prefix;
  DerivativeOptions options;  ///< Without what the scene decides.
  int gather_rays = 8192;
  std::optional<int> reference_rays;
  double exposure = 0.0;
};

/// Declares the options of the command on `command`; parsing fills `arguments`, which must live as long.
void declare_derivatives_options(CLI::App& command, DerivativesArguments& arguments);

/// Name of the file with a method's quantity, "gradient" or "hessian".
[[nodiscard]] std::filesystem::path derivative_picture_path(const std::string& prefix,
                                                            std::string_view method,
                                                            std::string_view quantity,
                                                            std::string_view extension);

/// Signed values as linear colours: 0 becomes the grey that PNG files hold as 0.5, -scale and below black,
/// scale and above white.
[[nodiscard]] Image signed_colors(const Image& image, double scale);

struct DerivativesRun {
  DerivativeImages images;
  DerivativesReport report;
};

/// Estimates the derivatives and writes all files. Throws InputError, and Interrupted when `stop` is raised.
[[nodiscard]] DerivativesRun run_derivatives(const DerivativesArguments& arguments,
                                             const std::string& command_line, const std::atomic<bool>& stop);

}  // namespace vrc
