// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "hard_pixels.h"
#include "tile_shader.h"

namespace vrc {

/// Shades some tiles of a picture with the records of a placer so far, and gathers at some of their pixels.
class TileTrials : public ShadingTrials {
 public:
  /// All must outlive it.
  TileTrials(const Scene& scene, const FilmSampler& film, const TileShader& shader, const Layers& layers,
             const TileLayout& layout, const RenderOptions& options, RecordPlacer& placer,
             const RunControl& control);

  double seconds_with(ShadingEffort effort) override;
  WorkBesideShading beside() override;

 private:
  /// Returns the time that all tiles would take.
  double shade(bool paths_where_open);
  void clear(std::size_t tile);

  const Scene& scene_;
  const FilmSampler& film_;
  const TileShader& shader_;
  const Layers& layers_;
  const TileLayout& layout_;
  const RenderOptions& options_;
  RecordPlacer& placer_;
  const RunControl& control_;
  std::vector<std::size_t> tiles_;
  Image image_;
  std::vector<PixelFacts> facts_;  ///< Of the film's pixels.
  std::optional<RadianceCache> cache_;
  double mean_luminance_ = 0.0;
  ShadingEffort effort_ = ShadingEffort::kFull;
  double seconds_ = 0.0;        ///< Of the latest effort, without paths.
  double all_per_tried_ = 1.0;  ///< Tiles.
};

}  // namespace vrc
