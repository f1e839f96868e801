// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/timing.h"
#include "error_goal.h"
#include "tile_shader.h"

namespace vrc {

/// Shades some pixels of each tile of a picture with the records of a placer so far.
class PixelTrial : public ErrorTrial {
 public:
  /// All must outlive it but the options.
  PixelTrial(const Scene& scene, const FilmSampler& film, const TileLayout& layout,
             const RenderOptions& options, RecordPlacer& placer, const RunControl& control);

  double relative_error(double error) override;

  /// Of all trials.
  [[nodiscard]] const PhaseTime& time() const { return time_; }
  [[nodiscard]] const RayCounts& counts() const { return counts_; }

 private:
  [[nodiscard]] std::vector<Pixel> pixels_of_tile(std::size_t tile) const;

  const Scene& scene_;
  const FilmSampler& film_;
  const TileLayout& layout_;
  RenderOptions options_;  ///< For indirect light alone.
  RecordPlacer& placer_;
  const RunControl& control_;
  std::size_t stride_;  ///< One pixel of so many is tried.
  PhaseTime time_{"expected error"};
  RayCounts counts_;
};

}  // namespace vrc
