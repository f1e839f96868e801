// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "transport/scene.h"

namespace vrc {

/// Sixteen camera rays through one pixel.
struct CameraPacket {
  I16 active;        ///< Lanes with a sample; fewer than sixteen in a pixel's last packet.
  V3x16 direction;   ///< Unit.
  U16 sample_index;  ///< Within the pixel.
  U16 pixel_seed;    ///< Equal in all lanes of a pixel.
};

/// Places the samples of each pixel by its reconstruction filter: positions are drawn with the
/// filter as density, so a pixel is the plain mean of its samples.
class FilmSampler {
 public:
  FilmSampler(const Camera& camera, const FilmDescription& film, int samples_per_pixel, std::uint64_t seed);

  [[nodiscard]] int packets_per_pixel() const { return (samples_per_pixel_ + kLanes - 1) / kLanes; }
  [[nodiscard]] int samples_per_pixel() const { return samples_per_pixel_; }
  [[nodiscard]] CameraPacket packet(int x, int y, int number) const;
  /// The `count` samples of each pixel that come after these.
  [[nodiscard]] FilmSampler further(int count) const;
  /// Ray from the camera along a packet's directions.
  [[nodiscard]] Ray16 ray(const CameraPacket& packet) const {
    return {origin_, packet.direction, splat(1e17f)};
  }

 private:
  V3x16 origin_, corner_, step_x_, step_y_;  // direction = corner + x step_x + y step_y
  FilmDescription film_;
  int first_sample_ = 0;
  int samples_per_pixel_;
  std::uint64_t seed_;
};

/// Directions through sixteen given film positions.
[[nodiscard]] V3x16 camera_directions(const Camera& camera, F16 film_x, F16 film_y);

}  // namespace vrc
