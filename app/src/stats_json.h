// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "shading/render.h"

namespace vrc {

/// How many records there are of each class. `needs_sh` and `reasons` count all of them only with
/// CacheOptions::classify_sites.
struct RecordClasses {
  std::uint64_t needs_sh = 0;  ///< The paper would represent them by spherical harmonics.
  std::array<std::uint64_t, kCurvatureReasons> reasons{};
  std::array<std::uint64_t, kHarmonicsReasons> harmonics{};

  [[nodiscard]] std::uint64_t taylor() const { return harmonics[0]; }
};

[[nodiscard]] RecordClasses count_classes(std::span<const RadianceRecord> records);

/// One finished run of `vrc render` or `vrc records`, as it is reported.
struct RunReport {
  std::string scene;
  std::string command_line;
  int width = 0;
  int height = 0;
  int threads = 0;
  RenderOptions options;
  RecordClasses classes;
  RenderStats stats;  ///< Its phases are all phases of the run, reading and writing included.
  double seconds = 0.0;
  double cpu_seconds = 0.0;
  double render_seconds = 0.0;  ///< What `rays_per_second` divides by.
  std::optional<double> relmse;
};

[[nodiscard]] std::uint64_t total_rays(const RenderStats& stats);
[[nodiscard]] double rays_per_second(const RunReport& report);

/// The command-line words of the options.
[[nodiscard]] std::string_view name_of(Method method);
[[nodiscard]] std::string_view name_of(Component component);

/// JSON text with the fields named as in the report; numbers that are not finite become null.
[[nodiscard]] std::string stats_json(const RunReport& report);
/// The frames of a fly-through: {"frames": [...]}, each as above.
[[nodiscard]] std::string frames_json(std::span<const RunReport> frames);

/// "12.3 s, 24.1 CPU s, 2051 records (143 of spherical harmonics), 18.2 M rays (8.10 M/s), 210 MB,
/// relMSE 4.6e-04"
[[nodiscard]] std::string summary_line(const RunReport& report);

}  // namespace vrc
