// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/camera_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "support.h"

namespace vrc {
namespace {

class CameraPath : public testing::Test {
 protected:
  [[nodiscard]] std::vector<Camera> read(const std::string& text) const {
    test::write_file(folder_ / "path.txt", text);
    return read_camera_path(folder_ / "path.txt", lens_);
  }
  [[nodiscard]] std::string error_of(const std::string& text) const {
    try {
      static_cast<void>(read(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  test::TempDir folder_;
  Camera lens_ = look_at(Vec3(0, 0, 5), Vec3(0, 0, 0), Vec3(0, 1, 0), 40.0, 320, 200);
};

TEST_F(CameraPath, HasACameraForEveryLine) {
  const auto cameras = read("# origin target up\n0 0 4  0 0 0\n\n1 2 3 0 0 0  0 0 1  # on its side\n");
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras[0].origin, Vec3(0, 0, 4));
  EXPECT_LT((cameras[0].forward - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((cameras[0].up - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_GT(cameras[1].up.z(), 0.5);
  for (const Camera& camera : cameras) {
    EXPECT_EQ(camera.width, 320);
    EXPECT_EQ(camera.height, 200);
    EXPECT_NEAR(camera.tan_half_width, lens_.tan_half_width, 1e-12);
  }
}

TEST_F(CameraPath, SaysWhatIsWrongAndWhere) {
  using testing::HasSubstr;
  EXPECT_THAT(error_of("0 0 4 0 0 0\n1 2 3\n"), HasSubstr("path.txt:2: 3 numbers"));
  EXPECT_THAT(error_of("0 0 4 0 0 zero\n"), HasSubstr("path.txt:1"));
  EXPECT_THAT(error_of("1 1 1 1 1 1\n"), HasSubstr("path.txt:1"));
  EXPECT_THAT(error_of("# nothing\n"), HasSubstr("no cameras"));
  EXPECT_THROW(static_cast<void>(read_camera_path(folder_ / "none.txt", lens_)), InputError);
}

}  // namespace
}  // namespace vrc
