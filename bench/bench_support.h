// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/image.h"
#include "shading/render.h"
#include "transport/scene_description.h"

namespace CLI {
class App;
}

/// What the benchmarks that measure the error of pictures share.
namespace vrc::bench {

struct PictureSettings {
  std::vector<std::string> scenes;
  std::vector<std::string> defines;  ///< NAME=VALUE
  int width = 512, height = 512;
  int samples_per_pixel = 16;
  /// Camera samples of a pixel of each of the three references, and the guided rays that they share; 0:
  /// paths.
  int reference_samples = 128;
  int reference_rays = 2048;
  std::string reference_dir = VRC_SOURCE_DIR "/build/references";
  int repeats = 3;  ///< Seeds to take medians over.
  int threads = 2;
};

/// Scenes, film and threads.
void declare_scene_options(CLI::App& app, PictureSettings& settings);
/// And what pictures and their references take.
void declare_picture_options(CLI::App& app, PictureSettings& settings);

[[nodiscard]] SceneDescription read_scene_for(const std::string& file, const PictureSettings& settings);

/// Indirect light of one bounce.
[[nodiscard]] RenderOptions indirect_light(Method method, int samples_per_pixel, std::uint64_t seed);

/// Pixels that an error is measured over, row by row.
using PixelMask = std::vector<bool>;

/// Of blocks of 8 x 8 pixels whose error, true or estimated, is more than the noise of the references.
struct EstimateQuality {
  double within_two = 0.0;  ///< Share whose true error is within a factor of two of the estimate.
  double measurable = 0.0;  ///< Share of all blocks that these are.
};

/// References of independent noise, scaled to a mean luminance of one half: errors are products of the
/// differences to the first two, relative to the third.
struct References {
  std::array<Image, 3> images;
  float scale = 1.0f;  ///< That the references were multiplied by, and pictures must be.

  [[nodiscard]] double error_of(const Image& image) const;
  [[nodiscard]] double error_of(const Image& image, const PixelMask& mask) const;
  /// Mean squares over blocks of 8 x 8 pixels: of the error of a picture's luminance, of what its layer
  /// error.Y foretells, and of the noise of the references.
  [[nodiscard]] Image error_blocks(const Image& image) const;
};

/// How well errors are foretold, by `References::error_blocks` of a picture or their means of several.
[[nodiscard]] EstimateQuality estimate_quality(const Image& error_blocks);

/// By path tracing; kept in files from run to run.
[[nodiscard]] References make_references(const Scene& scene, const SceneDescription& description,
                                         const std::string& file, const PictureSettings& settings);

[[nodiscard]] double median(std::vector<double> values);

/// Runs what a program does with its settings; what it throws becomes a message. Returns the exit code.
[[nodiscard]] int run_reported(const char* program, const PictureSettings& settings,
                               const std::function<void()>& work);

}  // namespace vrc::bench
