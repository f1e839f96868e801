// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/types.h"
#include "geometry/ellipse_tessellation.h"
#include "io/surface_export.h"
#include "placement/record.h"

namespace vrc {

/// What a record map shows of one cache record. World space; luminance derivatives are taken along
/// axis1 and axis2, per scene unit and per squared scene unit.
struct RecordMapEntry {
  Vec3f position = Vec3f::Zero();
  Vec3f normal = Vec3f::UnitZ();
  Vec3f axis1 = Vec3f::UnitX();  ///< Unit axes of the valid region, perpendicular to the normal.
  Vec3f axis2 = Vec3f::UnitY();
  float radius1 = 0.0f;  ///< Half axes of the valid region.
  float radius2 = 0.0f;
  Rgb radiance = Rgb::Zero();
  float luminance_deviation = 0.0f;  ///< Standard deviation of the gathered luminance: its noise.
  Vec2f gradient = Vec2f::Zero();
  Vec3f hessian = Vec3f::Zero();  ///< The entries 11, 12 and 22.
  float clamp_factor = 1.0f;      ///< < 1: how much the derivatives were reduced.
  float nearest_hit = 0.0f;       ///< Shortest gather ray; infinite when all escaped.
  float mean_hit = 0.0f;          ///< Harmonic mean of their lengths; infinite when all escaped.
  SiteCurvature curvature;
  std::uint32_t region = kInvalidIndex;
  std::uint32_t face = kInvalidIndex;   ///< Triangle of the scene.
  std::uint32_t patch = kInvalidIndex;  ///< Chart of the scene, and where in it.
  Vec2f uv = Vec2f::Zero();
  HarmonicsReason harmonics_reason = HarmonicsReason::kNone;
  std::uint64_t rays = 0;  ///< That were gathered.
  /// In the picture, in pixels from its upper left corner: the position, and what the half axes become to
  /// first order, so that the rim is film + cos(t) film_axis1 + sin(t) film_axis2. NaN behind the camera.
  Vec2f film = Vec2f::Zero();
  Vec2f film_axis1 = Vec2f::Zero();
  Vec2f film_axis2 = Vec2f::Zero();
};

/// One point for each record, with the properties
///   x y z nx ny nz, red green blue, quality, radius, r1 r2, e1x e1y e1z e2x e2y e2z, L_r L_g L_b,
///   L_stddev, g1 g2, h11 h12 h22, clamp_factor, nearest_hit, mean_hit, deviation, curvature,
///   relative_curvature, exponent, reason, is_sh, sh_reason, needs_sh, region, face, patch, u v, rays,
///   px py, p1x p1y, p2x p2y.
/// `quality` is the largest |eigenvalue| of the Hessian and `radius` is sqrt(r1 r2). `deviation` is the
/// angle by which the normal turns in the region [rad], `needs_sh` is 1 where it is above the theta_max that
/// is given or else 0.15 rad, and `reason` says what decided: 0 flat, 1 turns-little, 2 ellipse-turns, 3
/// surface-turns. `is_sh` is 1 for records that hold spherical harmonics, and `sh_reason` says why: 0 none, 1
/// always, 2 turns, 3 replaces-many, 4 narrow. `px` to `p2y` are the record's position and half axes in the
/// picture [pixels]. In .csv files reasons are words. Absent numbers are -1. Colours map the logarithm of
/// `radius` over the range of the file, dark for small; records of spherical harmonics are orange.
[[nodiscard]] SurfaceExport record_map(std::span<const RecordMapEntry> records);

/// The records' ellipses on the surface, those of record i being ellipses[i], with the arrays
///   nx ny nz, red green blue, quality (= sqrt(r1 r2)), record, is_sh
/// at the vertices. Colours are those of `record_map`.
[[nodiscard]] SurfaceExport record_ellipses(std::span<const RecordMapEntry> records,
                                            std::span<const EllipseTessellation> ellipses);

}  // namespace vrc
