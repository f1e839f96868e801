// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>

namespace vrc {

// World-space geometry and derivatives are double precision; single precision appears only at the
// Embree border, inside the 16-wide kernels and in stored images.
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;
using Box3 = Eigen::AlignedBox3d;

/// Linear RGB: radiance [W m^-2 sr^-1], intensity, or a dimensionless reflectance.
using Rgb = Eigen::Array3f;

/// What linear sRGB primaries (Rec. 709) add to luminance.
inline constexpr double kLuminance[3] = {0.212671, 0.715160, 0.072169};

template <typename Color>
[[nodiscard]] inline auto luminance(const Color& c) {
  using Scalar = std::remove_cvref_t<decltype(c[0])>;
  return Scalar(kLuminance[0]) * c[0] + Scalar(kLuminance[1]) * c[1] + Scalar(kLuminance[2]) * c[2];
}

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr float kPiF = 3.14159265358979f;
inline constexpr std::uint32_t kInvalidIndex = std::numeric_limits<std::uint32_t>::max();

}  // namespace vrc
