// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/run_control.h"
#include "pixel_facts.h"
#include "placement/pixel_gather.h"
#include "placement/tile.h"
#include "shading/render.h"
#include "time_budget.h"

namespace vrc {

/// Channel offsets of a rendered image.
struct Layers {
  Layers(bool errors, bool aovs);

  int direct = 3, indirect = 6, error = -1, albedo = -1, normal = -1, depth = -1;
  std::vector<std::string> names = {"R",        "G",          "B",          "direct.R",  "direct.G",
                                    "direct.B", "indirect.R", "indirect.G", "indirect.B"};
};

/// What a picture is shaded with.
struct LightSources {
  const RadianceCache* cache = nullptr;     ///< Null: none.
  const PixelGatherer* gatherer = nullptr;  ///< Of guided paths; null: a path from each sample.
  ShadingEffort effort = ShadingEffort::kFull;
  bool paths_where_open = true;  ///< From points that no record reaches.
};

/// Shades tiles of a picture. Const and thread-safe.
class TileShader {
 public:
  /// All must outlive it.
  TileShader(const Scene& scene, const RenderOptions& options, const FilmSampler& film, const Layers& layers,
             const RunControl& control);

  [[nodiscard]] bool wants_direct() const { return wants_direct_; }
  [[nodiscard]] bool wants_indirect() const { return wants_indirect_; }
  /// Of direct light, for each camera sample.
  [[nodiscard]] int light_samples(ShadingEffort effort) const;
  /// Camera samples beyond the others' that pixels with edges get.
  [[nodiscard]] int further_edge_samples(ShadingEffort effort) const;

  /// The layers of these pixels, which lie together and are 0, but for R, G, B and `error`, and their facts.
  /// Image and facts are those of the whole film.
  void shade(const std::vector<Pixel>& pixels, const LightSources& sources, Image& image,
             std::span<PixelFacts> facts, RayCounts& counts) const;

 private:
  struct Packet;

  void shade(const Packet& packet, float* pixel, PixelFacts& facts, RayCounts& counts) const;
  void add_paths(const Packet& packet, int bounces, bool indirect, float* pixel, RayCounts& counts) const;
  void trace_open(const Packet& packet, Interpolated16& light, RayCounts& counts) const;
  void add_gathered(const Packet& packet, PixelGatherer::Surfaces& surfaces, float* pixel,
                    RayCounts& counts) const;
  void add_aovs(const Packet& packet, float* pixel) const;
  [[nodiscard]] PathSampler16 sampler(const CameraPacket& packet, int i) const;

  const Scene& scene_;
  const RenderOptions& options_;
  const FilmSampler& film_;
  const Layers& layers_;
  const RunControl& control_;
  bool wants_direct_, wants_indirect_;
};

}  // namespace vrc
