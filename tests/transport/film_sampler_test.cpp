// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/film_sampler.h"

#include <gtest/gtest.h>

#include "statistics.h"

namespace vrc {
namespace {

Camera camera() { return look_at(Vec3(1, 2, 3), Vec3(-1, 0.5, -2), Vec3::UnitY(), 60.0, 40, 30); }

/// Film position that a direction came through.
Vec2 film_position(const Camera& c, const Vec3& direction) {
  const Vec3 d = direction / direction.dot(c.forward);
  return {0.5 * c.width + d.dot(c.right) / c.pixel_size(), 0.5 * c.height - d.dot(c.up) / c.pixel_size()};
}

template <typename Body>
void for_samples(const FilmSampler& sampler, int x, int y, const Body& body) {
  for (int number = 0; number < sampler.packets_per_pixel(); ++number) {
    const CameraPacket packet = sampler.packet(x, y, number);
    for (int i = 0; i < kLanes; ++i) {
      if (packet.active[i] != 0) body(packet, i);
    }
  }
}

TEST(FilmSampler, BoxSamplesStratifyTheirPixel) {
  const FilmSampler sampler(camera(), {PixelFilter::kBox, 0.5}, 64, 3);
  std::vector<int> cells(64);
  for_samples(sampler, 31, 7, [&](const CameraPacket& packet, int i) {
    const Vec3 w = lane(packet.direction, i);
    EXPECT_NEAR(w.norm(), 1.0, 1e-6);
    const Vec2 p = film_position(camera(), w) - Vec2(31, 7);
    ASSERT_TRUE((p.array() > -1e-4).all() && (p.array() < 1.0 + 1e-4).all()) << p.transpose();
    ++cells[static_cast<std::size_t>(8 * std::clamp(static_cast<int>(8 * p.y()), 0, 7) +
                                     std::clamp(static_cast<int>(8 * p.x()), 0, 7))];
  });
  // A net has one sample in each cell, up to those that rounding moves over a border.
  EXPECT_GE(std::ranges::count(cells, 1), 60);
}

TEST(FilmSampler, GaussianHasItsDeviation) {
  const FilmSampler sampler(camera(), {PixelFilter::kGaussian, 0.5}, 4096, 3);
  Estimate x, y, xx, yy;
  for_samples(sampler, 20, 15, [&](const CameraPacket& packet, int i) {
    const Vec2 p = film_position(camera(), lane(packet.direction, i)) - Vec2(20.5, 15.5);
    EXPECT_LT(p.norm(), 4.0 * 0.5 + 1e-3);
    x.add(p.x());
    y.add(p.y());
    xx.add(p.x() * p.x());
    yy.add(p.y() * p.y());
  });
  EXPECT_NEAR(x.mean(), 0.0, 0.005);
  EXPECT_NEAR(y.mean(), 0.0, 0.005);
  EXPECT_NEAR(xx.mean(), 0.25, 0.005);
  EXPECT_NEAR(yy.mean(), 0.25, 0.005);
}

TEST(FilmSampler, CountsSamplesExactly) {
  for (const int samples : {1, 15, 16, 17, 100}) {
    const FilmSampler sampler(camera(), {}, samples, 1);
    EXPECT_EQ(sampler.packets_per_pixel(), (samples + 15) / 16);
    std::vector<int> seen(static_cast<std::size_t>(samples));
    for_samples(sampler, 0, 0, [&](const CameraPacket& packet, int i) { ++seen.at(packet.sample_index[i]); });
    EXPECT_EQ(std::ranges::count(seen, 1), samples);
  }
}

TEST(FilmSampler, FurtherSamplesContinueTheSequence) {
  const FilmSampler few(camera(), {}, 16, 1), many(camera(), {}, 48, 1);
  const FilmSampler further = few.further(32);
  EXPECT_EQ(further.packets_per_pixel(), 2);
  for (int number = 0; number < 2; ++number) {
    const CameraPacket a = further.packet(3, 4, number), b = many.packet(3, 4, number + 1);
    for (int i = 0; i < kLanes; ++i) {
      EXPECT_EQ(a.sample_index[i], b.sample_index[i]);
      EXPECT_EQ(lane(a.direction, i), lane(b.direction, i));
    }
  }
}

TEST(FilmSampler, PixelsAndSeedsDiffer) {
  const FilmSampler one(camera(), {}, 16, 1), two(camera(), {}, 16, 2);
  EXPECT_NE(one.packet(3, 4, 0).pixel_seed[0], one.packet(4, 3, 0).pixel_seed[0]);
  EXPECT_NE(one.packet(3, 4, 0).pixel_seed[0], two.packet(3, 4, 0).pixel_seed[0]);
  EXPECT_EQ(one.packet(3, 4, 0).pixel_seed[5], one.packet(3, 4, 0).pixel_seed[0]);
}

TEST(FilmSampler, GivenPositionsMatchTheCamera) {
  const Camera c = camera();
  const V3x16 w = camera_directions(c, splat(12.25f), splat(29.5f));
  EXPECT_LT((lane(w, 6) - c.direction(12.25, 29.5).normalized()).norm(), 1e-6);
}

}  // namespace
}  // namespace vrc
