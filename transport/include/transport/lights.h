// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/simd.h"
#include "transport/scene_description.h"

namespace vrc {

/// A triangle that emits on the side of its normal.
struct EmissiveTriangle {
  Vec3f p0, e1, e2;  ///< Vertex and edges.
  Vec3f normal;      ///< Unit.
  float area = 0.0f;
  Rgb radiance = Rgb::Zero();
  std::uint32_t triangle = 0;  ///< In the scene.
};

/// Light that arrives at a point from one sampled light.
struct LightSample16 {
  I16 valid;
  V3x16 direction;  ///< Unit, towards the light.
  F16 distance;
  V3x16 radiance;  ///< Radiance (or its equivalent) divided by the density of the sample.
  F16 pdf;         ///< Per solid angle; 0 for lights that no BSDF sample can hit.
};

[[nodiscard]] inline LightSample16 select(I16 mask, const LightSample16& yes, const LightSample16& no) {
  return {select(mask, yes.valid, no.valid), select(mask, yes.direction, no.direction),
          select(mask, yes.distance, no.distance), select(mask, yes.radiance, no.radiance),
          select(mask, yes.pdf, no.pdf)};
}

/// What rays from a surface met of the lights.
struct MetLight16 {
  I16 valid{};       ///< Met an emitter or the environment.
  V3x16 radiance{};  ///< That it sends back along the ray.
  F16 pdf{};         ///< Density per solid angle with which Lights::sample picks the ray's direction.
};

/// Chooses lights by power and points on them by area.
class Lights {
 public:
  Lights() = default;
  /// `scene_radius`: of the bounding sphere.
  Lights(std::vector<EmissiveTriangle> triangles, std::vector<DeltaLight> delta_lights,
         const Rgb& environment, double scene_radius);

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] const Rgb& environment() const { return environment_; }
  [[nodiscard]] const std::vector<EmissiveTriangle>& triangles() const { return triangles_; }

  /// `n` is the surface normal at `position` (directions to the environment are cosine-distributed).
  [[nodiscard]] LightSample16 sample(const V3x16& position, const V3x16& n, F16 u1, F16 u2) const;

  /// Radiance that emissive triangle `light` (index into triangles()) sends along -direction.
  [[nodiscard]] V3x16 emitted(I16 active, I16 light, const V3x16& direction) const;
  /// Density with which `sample` picks the point hit at `distance` along `direction`.
  [[nodiscard]] F16 pdf_of_hit(I16 active, I16 light, const V3x16& direction, F16 distance) const;
  /// Lights with an extent, which rays can meet.
  [[nodiscard]] bool can_be_met() const { return !triangles_.empty() || environment_probability_ > 0.0f; }
  /// What rays along `direction` met: `hit` lanes an emissive triangle `light` (or -1: none) at `distance`,
  /// the others the environment. `cosine` is that of the direction at the rays' origin.
  [[nodiscard]] MetLight16 met(I16 active, I16 hit, I16 light, const V3x16& direction, F16 distance,
                               F16 cosine) const;
  /// Density with which `sample` picks an environment direction.
  [[nodiscard]] F16 pdf_of_environment(F16 cosine) const;

 private:
  enum class Kind { kTriangle, kPoint, kDirectional, kEnvironment };
  struct Entry {
    Kind kind;
    std::uint32_t index;
    float probability;
    float cdf_begin;
    float cdf_end;
  };
  struct Chosen {
    I16 entry;
    F16 u;  ///< What is left of u1, stretched to [0, 1).
  };
  [[nodiscard]] Chosen choose(F16 u1) const;
  void sample_triangle(const EmissiveTriangle& light, I16 mask, const V3x16& position, F16 u1, F16 u2,
                       float probability, LightSample16& out) const;

  std::vector<EmissiveTriangle> triangles_;
  std::vector<float> triangle_probability_;
  std::vector<DeltaLight> delta_lights_;
  Rgb environment_ = Rgb::Zero();
  float environment_probability_ = 0.0f;
  float far_ = 1e9f;
  std::vector<Entry> entries_;
};

}  // namespace vrc
