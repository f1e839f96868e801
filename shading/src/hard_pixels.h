// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/image.h"
#include "core/run_control.h"
#include "core/timing.h"
#include "pixel_facts.h"
#include "placement/pixel_gather.h"
#include "placement/tile.h"

namespace vrc {

struct HardPixelOptions {
  double error = 0.03;           ///< Accepted relative error.
  double mean_luminance = 1.0;   ///< Of the picture's indirect light.
  double seconds = 0.0;          ///< > 0: wall-clock time to fill, instead of all hard pixels.
  int further_edge_samples = 0;  ///< As the pixels were shaded with.
  int bounces = 1;
  std::uint64_t seed = 0;
};

/// Gathers again at the pixels whose records disagree or that see an edge, from the points of their own
/// samples, and blends the result with what the records say by the errors of both. Gathers at one random
/// pixel of each tile tell how well the errors of all others are estimated.
class HardPixels {
 public:
  /// All must outlive it. `facts` are those of the film's pixels, row by row; channels `first` to first + 2
  /// of the image hold what the records say of the indirect light.
  HardPixels(const Scene& scene, const FilmSampler& film, const RadianceCache& cache,
             std::span<PixelFacts> facts, Image& image, int first, const HardPixelOptions& options);

  /// Gather rays of a pixel for an accepted error.
  [[nodiscard]] static double rays_per_pixel(double error);
  /// For an accepted error; `relative_error` is the pixel's, estimated and squared.
  [[nodiscard]] static bool is_hard(const PixelFacts& facts, float relative_error, double error);

  /// Wall-clock time of a gather ray, tried at a pixel of each tile that has facts. Before `refine`, of which
  /// nothing is done.
  [[nodiscard]] double seconds_per_ray(const TileLayout& layout, const RunControl& control) const;

  /// Corrects the image, and sets `squared_error` of the facts of all pixels of the layout to what is left.
  void refine(const TileLayout& layout, const RunControl& control, RayCounts& counts);

  /// Pixels that were gathered again.
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Of the picture's indirect luminance: estimated root of the mean of squared error / `perceived` squared
  /// over the pixels that show some.
  [[nodiscard]] double relative_error() const { return relative_error_; }

 private:
  struct Sampled {
    Pixel pixel;
    std::size_t tile;
    bool hard;          ///< false: of the survey alone.
    double rays = 0.0;  ///< Of each of the two gathers.
    /// Indirect light by the mean of two gathers of independent rays, less what the records say.
    Rgb residual = Rgb::Zero();
    // Of luminance, relative to `perceived`:
    std::array<float, 2> difference{};  ///< Of each gather to the records.
    float bias = 0.0f;                  ///< Product of the two: the records' squared error, on average.
    float noise = 0.0f;                 ///< Squared error of the gathers' mean, on average.
    float detail = 0.0f;                ///< Squared error of the residuals' mean around, on average.
  };
  /// Means over the pixels around one that were gathered again and show the same surface.
  struct Around {
    float weight = 0.0f;  ///< Their sum; 0: there are none.
    float share = 0.0f;   ///< Of the correction: falls to 0 away from them.
    Rgb residual = Rgb::Zero();
    std::array<float, 2> difference{};
    float bias = 0.0f, noise = 0.0f, detail = 0.0f;
    float sure_detail = 0.0f;    ///< Of `detail`, what is more than its scatter.
    float noise_of_mean = 0.0f;  ///< Of the mean of `residual`.
    float usual_noise = 0.0f;    ///< Squared mean of the noises' roots.

    /// By what a gather's weight is multiplied: one that found a rare bright thing would spoil the means.
    [[nodiscard]] float trust(float noise_of_one) const;
  };

  struct Correction {
    Rgb change = Rgb::Zero();
    float error = -1.0f;  ///< Relative squared error that is left; < 0: as it was.
  };

  [[nodiscard]] float accepted() const;  ///< Relative squared error up to which pixels are not hard.
  [[nodiscard]] bool is_hard(std::size_t index) const;
  /// One pixel of each tile, in an order of which every beginning is spread over the picture.
  [[nodiscard]] std::vector<Sampled> survey(const TileLayout& layout) const;
  /// All hard pixels or, where time is to be filled, all pixels, the hardest first; without those gathered so
  /// far.
  [[nodiscard]] std::vector<Sampled> candidates(const TileLayout& layout) const;
  /// Gathers at all of these pixels or, where time is to be filled, at the first ones, until it is up to
  /// `share`.
  void gather_within(double share, const PhaseTimer& timer, const std::vector<Sampled>& all,
                     const RunControl& control, RayCounts& counts);
  /// Gathers more rays where what was gathered leaves pixels hard.
  void gather_further(const RunControl& control, RayCounts& counts);
  /// Gathers at the chosen pixels, with more rays at those that have some, and puts them into `sampled_`.
  void gather(std::vector<Sampled> chosen, const RunControl& control, RayCounts& counts);
  void gather_at(std::vector<Sampled>& chosen, const RunControl& control, RayCounts& counts) const;
  void gather_in_tile(std::span<Sampled> chosen, RayCounts& counts) const;
  void calibrate(const TileLayout& layout);
  /// Calls body(weight, sampled) for the pixels around that show the same surface; `sampled` is null where
  /// there was no gather.
  template <typename Body>
  void for_each_alike(const Pixel& pixel, const Body& body) const;
  [[nodiscard]] Around around(const Pixel& pixel) const;
  void find_detail();
  [[nodiscard]] Correction correction_of(const Pixel& pixel) const;
  /// 1 for pixels that one of the hard ones may correct.
  [[nodiscard]] std::vector<std::uint8_t> near_hard() const;
  void blend(const TileLayout& layout);
  void sum_up(const TileLayout& layout);
  [[nodiscard]] std::size_t index_of(const Pixel& p) const;
  [[nodiscard]] float square_scale_of(std::size_t index) const { return scale_[index] * scale_[index]; }
  [[nodiscard]] float relative_error_of(std::size_t index) const;  ///< Squared, at the samples.

  const Scene& scene_;
  const FilmSampler& film_;
  std::span<PixelFacts> facts_;
  Image& image_;
  int first_;
  HardPixelOptions options_;
  GuideField guides_;
  PixelGatherer gatherer_;
  std::vector<float> scale_;  ///< `perceived` luminance of each pixel of the film.
  std::vector<Sampled> sampled_;
  std::vector<std::int32_t> sampled_at_;  ///< Per pixel of the film: its entry, or -1.
  std::size_t count_ = 0;                 ///< Of hard ones.
  double relative_error_ = 0.0;
  double seconds_per_pixel_ = 0.0;  ///< Of the latest gathers; 0: not known.
};

}  // namespace vrc
