// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/film_sampler.h"

#include "core/hash.h"
#include "core/sobol.h"

namespace vrc {

FilmSampler::FilmSampler(const Camera& camera, const FilmDescription& film, int samples_per_pixel,
                         std::uint64_t seed)
    : origin_(splat3(camera.origin)), film_(film), samples_per_pixel_(samples_per_pixel), seed_(seed) {
  const Vec3 corner = camera.direction(0.0, 0.0);
  corner_ = splat3(corner);
  step_x_ = splat3(Vec3(camera.direction(1.0, 0.0) - corner));
  step_y_ = splat3(Vec3(camera.direction(0.0, 1.0) - corner));
}

FilmSampler FilmSampler::further(int count) const {
  FilmSampler result = *this;
  result.first_sample_ += samples_per_pixel_;
  result.samples_per_pixel_ = count;
  return result;
}

CameraPacket FilmSampler::packet(int x, int y, int number) const {
  CameraPacket p;
  const I16 index = lane_index() + number * kLanes;
  p.active = index < samples_per_pixel_;
  p.sample_index = std::bit_cast<U16>(index + first_sample_);
  p.pixel_seed = splat(static_cast<std::uint32_t>(
      hash(seed_, 0xf11au, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))));
  const Sample4 u = padded_sobol(p.sample_index, p.pixel_seed);
  F16 dx = u.u[0], dy = u.u[1];
  if (film_.filter == PixelFilter::kGaussian) {
    // Box-Muller, truncated at the four standard deviations of the filter's support.
    const F16 radius =
        sqrt(max(-2.0f * 0.69314718f * log2(max(1.0f - u.u[0] * (1.0f - 3.3546263e-4f), 1e-9f)), 0.0f)) *
        static_cast<float>(film_.gaussian_stddev);
    const SinCos16 angle = sincos_2pi(u.u[1]);
    dx = 0.5f + radius * angle.cos;
    dy = 0.5f + radius * angle.sin;
  }
  p.direction =
      normalize(corner_ + step_x_ * (dx + static_cast<float>(x)) + step_y_ * (dy + static_cast<float>(y)));
  return p;
}

V3x16 camera_directions(const Camera& camera, F16 film_x, F16 film_y) {
  const Vec3 corner = camera.direction(0.0, 0.0);
  return normalize(splat3(corner) + splat3(Vec3(camera.direction(1.0, 0.0) - corner)) * film_x +
                   splat3(Vec3(camera.direction(0.0, 1.0) - corner)) * film_y);
}

}  // namespace vrc
