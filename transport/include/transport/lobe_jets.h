// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/jet2.h"
#include "core/simd.h"
#include "transport/lobes.h"

namespace vrc {

using UnitJet16 = UnitJet<F16>;
using TiltingJet16 = TiltingJet<F16>;

/// How the scalars of a record's gather change while the record's point x moves over its surface by
/// the tangent displacement d, its normal turns by m, and everything else stays: the hit y, its light sample,
/// the camera.
///
/// With the shape operator S, x(d) = x + d - n (d^T S d)/2 and n(m) = normalize(n + m); m = S d, by
/// `along_surface`, makes total derivatives, S = 0 and no m the translational ones of [Zhao eq. 10-11].
/// r = y - x and v = camera - x are not normalised. Components are along the record's tangents.
struct MovingPoint16 {
  float s11, s12, s22;  ///< S. [1/length]
  F16 r1, r2;           ///< Tangential part of r.
  F16 v1, v2;           ///< Tangential part of v (equal lanes).
  F16 nr, nv;           ///< n . r and n . v
  F16 rr, vv, rv;       ///< r . r, v . v, r . v
  UnitJet16 jet_rr, jet_vv;
  bool masking_moves = true;  ///< RecordFrame's.
};

/// What does not depend on the gather ray.
struct RecordFrame {
  Vec3f x, tangent, bitangent, normal;
  Vec3f to_camera;  ///< v
  Eigen::Matrix2f shape_operator = Eigen::Matrix2f::Zero();
  bool masking_moves = true;  ///< false: G2 of GGX is held fixed [Zhao 4.3.2].
};

[[nodiscard]] MovingPoint16 moving_point(const RecordFrame& frame, const V3x16& r);

/// The jet of a . (y - x) for a fixed vector a, up to sign: pass the value's sign in `a`.
/// a1, a2 are the tangential parts of a, an its normal part, `value` = a . r.
[[nodiscard]] inline UnitJet16 jet_of_linear(const MovingPoint16& p, F16 value, F16 a1, F16 a2, F16 an) {
  return unit_jet<F16>(1.0f / value, -a1, -a2, an * p.s11, an * p.s12, an * p.s22);
}

/// Jets of n . r and n . v. `Jet` is TiltingJet16, or where nothing bends UnitJet16.
template <typename Jet>
[[nodiscard]] Jet jet_of_nr(const MovingPoint16& p);
template <typename Jet>
[[nodiscard]] Jet jet_of_nv(const MovingPoint16& p);

/// Jets of shape(lobe) * |r| at the moving point x: f_r (n . r), the cosine not normalised. Fresnel's
/// term is held fixed [Zhao 4.3.2]. `Jet` as above.
template <typename Jet>
[[nodiscard]] Jet shape_jet(const LambertLobe& lobe, const MovingPoint16& p);
template <typename Jet>
[[nodiscard]] Jet shape_jet(const PhongLobe& lobe, const MovingPoint16& p);
template <typename Jet>
[[nodiscard]] Jet shape_jet(const GgxLobe& lobe, const MovingPoint16& p);

/// A fixed reflector y seen from the moving point x: its normal, the fixed direction of its incident
/// light, and their parts along the record's frame.
struct FixedReflector16 {
  V3x16 n;        ///< Shading normal at y, on the side of x, in the record's frame.
  V3x16 light;    ///< Unit direction to the light at y, in the record's frame.
  F16 nr;         ///< n . r, negative
  F16 light_cos;  ///< n . light
  F16 light_r;    ///< light . r
};

/// Jets of the BRDF at y towards x: the glossy-glossy term of [Zhao eq. 12]. Lambert's is 0.
[[nodiscard]] UnitJet16 reflector_jet(const LambertLobe& lobe, const FixedReflector16& y,
                                      const MovingPoint16& p);
[[nodiscard]] UnitJet16 reflector_jet(const PhongLobe& lobe, const FixedReflector16& y,
                                      const MovingPoint16& p);
[[nodiscard]] UnitJet16 reflector_jet(const GgxLobe& lobe, const FixedReflector16& y, const MovingPoint16& p);

}  // namespace vrc
