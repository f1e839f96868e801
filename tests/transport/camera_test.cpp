// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/camera.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"

namespace vrc {
namespace {

using ::testing::HasSubstr;

void expect_near(const Vec3& actual, const Vec3& expected) {
  EXPECT_LT((actual - expected).norm(), 1e-12)
      << actual.transpose() << " instead of " << expected.transpose();
}

TEST(Camera, LookAtMakesARightHandedFrame) {
  const Camera camera = look_at(Vec3(0, 0, 5), Vec3(0, 0, 0), Vec3(0, 2, 1), 90.0, 200, 100);
  expect_near(camera.forward, Vec3(0, 0, -1));
  expect_near(camera.right, Vec3(1, 0, 0));
  expect_near(camera.up, Vec3(0, 1, 0));
  expect_near(camera.right.cross(camera.up), -camera.forward);
  EXPECT_NEAR(camera.tan_half_width, 1.0, 1e-12);

  const Camera tilted = look_at(Vec3(1, 2, 3), Vec3(-2, 0.5, 7), Vec3(0.1, 1, 0.3), 30.0, 64, 64);
  expect_near(tilted.right.cross(tilted.up), -tilted.forward);
  EXPECT_NEAR(tilted.right.norm(), 1.0, 1e-12);
  EXPECT_NEAR(tilted.up.norm(), 1.0, 1e-12);
  EXPECT_NEAR(tilted.right.dot(Vec3(0.1, 1, 0.3)), 0.0, 1e-12) << "right is level";
}

TEST(Camera, PixelZeroIsTopLeft) {
  const Camera camera = look_at(Vec3(0, 0, 5), Vec3(0, 0, 0), Vec3::UnitY(), 90.0, 200, 100);
  expect_near(camera.direction(0, 0), Vec3(-1, 0.5, -1));
  expect_near(camera.direction(200, 100), Vec3(1, -0.5, -1));
  expect_near(camera.direction(100, 50), Vec3(0, 0, -1));
  EXPECT_LT((camera.film_position(camera.origin + 3.0 * camera.direction(30, 80)) - Vec2(30, 80)).norm(),
            1e-9);
  expect_near(camera.direction(101, 51) - camera.direction(100, 50), Vec3(0.01, -0.01, 0));
  EXPECT_NEAR(camera.pixel_size(), 0.01, 1e-15);
}

TEST(Camera, FieldOfViewSpansTheWidth) {
  const Camera camera = look_at(Vec3(1, 1, 1), Vec3(4, 1, 1), Vec3::UnitY(), 50.0, 300, 700);
  const Vec3 left = camera.direction(0, 350).normalized();
  const Vec3 right = camera.direction(300, 350).normalized();
  EXPECT_NEAR(std::acos(left.dot(right)) * 180.0 / kPi, 50.0, 1e-9);
}

TEST(Camera, ResizeKeepsTheHorizontalField) {
  Camera camera = look_at(Vec3(0, 0, 5), Vec3(0, 0, 0), Vec3::UnitY(), 90.0, 200, 100);
  camera.resize(50, 100);
  expect_near(camera.direction(0, 0), Vec3(-1, 2, -1));
  EXPECT_THROW(camera.resize(0, 10), std::logic_error);
}

TEST(Camera, LookAtRefusesWhatHasNoFrame) {
  struct Case {
    Vec3 origin, target, up;
    double fov;
    const char* message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Case cases[] = {
      {{1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 40.0, "origin and target coincide"},
      {{0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 40.0, "up vector is zero or parallel"},
      {{0, 5, 0}, {0, 0, 0}, {0, -3, 0}, 40.0, "up vector is zero or parallel"},
      {{0, 0, 5}, {0, 0, 0}, {0, 0, 0}, 40.0, "up vector is zero or parallel"},
      {{0, 0, nan}, {0, 0, 0}, {0, 1, 0}, 40.0, "not finite"},
      {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.0, "between 0 and 180"},
      {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 180.0, "between 0 and 180"},
      {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, nan, "between 0 and 180"},
  };
  for (const Case& c : cases) {
    try {
      static_cast<void>(look_at(c.origin, c.target, c.up, c.fov, 10, 10));
      ADD_FAILURE() << "accepted; expected: " << c.message;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.message));
    }
  }
}

}  // namespace
}  // namespace vrc
