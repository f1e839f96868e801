// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/simd.h"

namespace vrc {

/// Sixteen rays. Directions need not be normalised; distances are in units of their length.
struct Ray16 {
  V3x16 origin;
  V3x16 direction;
  F16 t_max;
};

struct Hit16 {
  I16 hit;       ///< Mask.
  I16 triangle;  ///< Undefined where there is no hit.
  F16 t, u, v;   ///< Barycentric: p0 + u (p1 - p0) + v (p2 - p0).
};

/// Nearest and any hits on a triangle list by Embree, in its robust mode.
class RayTracer {
 public:
  /// `positions`: 3 floats a vertex; `indices`: 3 a triangle. All finite, below 1e18 in magnitude.
  RayTracer(std::span<const float> positions, std::span<const std::uint32_t> indices);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;

  enum class Coherence { kIncoherent, kCoherent };

  /// Lanes with a ray that is not finite miss.
  [[nodiscard]] Hit16 intersect(I16 active, const Ray16& ray, Coherence coherence) const;
  /// Mask of the active lanes whose ray meets something before t_max.
  [[nodiscard]] I16 occluded(I16 active, const Ray16& ray, Coherence coherence) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vrc
