// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "core/run_control.h"
#include "shading/render.h"
#include "transport/path_tracer.h"
#include "transport/scene.h"

namespace vrc {

/// Ways to estimate the derivatives of the indirect radiance towards the camera [Zhao Fig. 5].
enum class DerivativeMethod {
  kAnalytic,          ///< Closed forms, `gather_radiance`.
  kNoGlossyGlossy,    ///< The same without the derivative of what glossy surfaces send.
  kHarmonics,         ///< Spherical harmonics of incident radiance, and a BRDF in them that moves.
  kFiniteDifferences  ///< Of gathers beside the point: the reference.
};
inline constexpr std::size_t kDerivativeMethods = 4;

/// "analytic", "no-glossy-glossy", "sh", "finite-differences".
[[nodiscard]] std::string_view name_of(DerivativeMethod method);

struct DerivativeOptions {
  int log2_rays = 13;            ///< Of a gather, k >= 10.
  int log2_reference_rays = 15;  ///< Of each gather of the finite differences.
  int bounces = 1;               ///< Of indirect light; not 0.
  int harmonics_order = 0;       ///< 0: harmonics_order_for.
  /// Of the finite differences, in lengths of a pixel at the point, facing the camera; 0: kStepShare of the
  /// film's width. Where the surface ends within it, the pixel is not valid; elsewhere it is limited to
  /// kNearestShare of the distance to the nearest hit.
  double step = 0.0;
  std::uint64_t seed = 0;
  std::optional<CropWindow> crop;  ///< Pixels outside are not valid.

  static constexpr double kStepShare = 0.03;
  static constexpr double kNearestShare = 0.3;
};

/// Of luminance along a surface, on world axes: T g and T H T^T for g and H in tangent coordinates, T the
/// tangents in columns. [W m^-2 sr^-1 / length], [W m^-2 sr^-1 / length^2]
struct WorldDerivatives {
  Vec3f gradient = Vec3f::Zero();
  Eigen::Matrix3f hessian = Eigen::Matrix3f::Zero();
};

/// At what the centres of the film's pixels show, row by row.
struct DerivativeImages {
  int width = 0, height = 0;
  /// Invalid pixels show no surface that reflects, or one that ends within the step of the finite
  /// differences; their derivatives are 0.
  std::vector<std::uint8_t> valid;
  std::array<std::vector<WorldDerivatives>, kDerivativeMethods> methods;
  std::array<double, kDerivativeMethods> cpu_seconds{};  ///< All valid pixels together.
  RayCounts counts;
  int harmonics_order = 0;
  double step = 0.0;  ///< As in the options, never 0.

  [[nodiscard]] const std::vector<WorldDerivatives>& of(DerivativeMethod method) const {
    return methods[static_cast<std::size_t>(method)];
  }
  [[nodiscard]] std::size_t valid_count() const;
};

/// The derivatives are the same at any number of threads. Throws Interrupted when `control` is stopped.
[[nodiscard]] DerivativeImages estimate_derivatives(const Scene& scene, const DerivativeOptions& options,
                                                    const RunControl& control = {});

/// R, G, B = dL/dx, dL/dy, dL/dz.
[[nodiscard]] Image gradient_image(const DerivativeImages& images, DerivativeMethod method);
/// R, G, B = the entries xx, yy, xy of the Hessian.
[[nodiscard]] Image hessian_image(const DerivativeImages& images, DerivativeMethod method);

/// The 99th percentile of the absolute values that the channels of valid pixels hold; 0 without any.
[[nodiscard]] double robust_scale(const DerivativeImages& images, const Image& image);
/// Against the finite differences, over valid pixels; norms of vectors and matrices.
struct DerivativeError {
  double relative_rms = 0.0;     ///< Root of the sum of squared errors over that of the squared reference.
  double median_relative = 0.0;  ///< Median of error / reference where the reference is not 0.
};
[[nodiscard]] DerivativeError gradient_error(const DerivativeImages& images, DerivativeMethod method);
[[nodiscard]] DerivativeError hessian_error(const DerivativeImages& images, DerivativeMethod method);

}  // namespace vrc
