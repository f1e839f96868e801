// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures and errors of derivatives.
#include <algorithm>
#include <cmath>

#include "shading/derivative_images.h"

namespace vrc {
namespace {

constexpr double kScaleShare = 0.99;  // of the values that a picture does not clip

/// The element of which the given share is smaller; 0 without any.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto last = static_cast<double>(values.size() - 1);
  const auto found = values.begin() + std::lround(share * last);
  std::ranges::nth_element(values, found);
  return *found;
}

/// `channels(derivatives)` are the three values of a pixel.
template <typename Channels>
Image draw(const DerivativeImages& images, DerivativeMethod method, const Channels& channels) {
  Image image(images.width, images.height, {"R", "G", "B"});
  const std::vector<WorldDerivatives>& derivatives = images.of(method);
  for (std::size_t p = 0; p < derivatives.size(); ++p) {
    const Vec3f v = channels(derivatives[p]);
    std::copy(v.begin(), v.end(), image.pixels.begin() + static_cast<std::ptrdiff_t>(3 * p));
  }
  return image;
}

/// Of the quantity that `part` takes from the derivatives.
template <typename Part>
DerivativeError error_of(const DerivativeImages& images, DerivativeMethod method, const Part& part) {
  double error_sum = 0.0, reference_sum = 0.0;
  std::vector<double> relative;
  for (std::size_t p = 0; p < images.valid.size(); ++p) {
    if (images.valid[p] == 0) continue;
    const auto reference =
        part(images.of(DerivativeMethod::kFiniteDifferences)[p]).template cast<double>().eval();
    const auto estimate = part(images.of(method)[p]).template cast<double>().eval();
    const double error = (estimate - reference).squaredNorm(), size = reference.squaredNorm();
    error_sum += error;
    reference_sum += size;
    if (size > 0.0) relative.push_back(std::sqrt(error / size));
  }
  return {reference_sum > 0.0 ? std::sqrt(error_sum / reference_sum) : 0.0,
          quantile(std::move(relative), 0.5)};
}

}  // namespace

Image gradient_image(const DerivativeImages& images, DerivativeMethod method) {
  return draw(images, method, [](const WorldDerivatives& d) { return d.gradient; });
}

Image hessian_image(const DerivativeImages& images, DerivativeMethod method) {
  return draw(images, method, [](const WorldDerivatives& d) -> Vec3f {
    return {d.hessian(0, 0), d.hessian(1, 1), d.hessian(0, 1)};
  });
}

double robust_scale(const DerivativeImages& images, const Image& image) {
  std::vector<double> values;
  for (std::size_t p = 0; p < images.valid.size(); ++p) {
    if (images.valid[p] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) values.push_back(std::abs(image.pixels[3 * p + c]));
  }
  return quantile(std::move(values), kScaleShare);
}

DerivativeError gradient_error(const DerivativeImages& images, DerivativeMethod method) {
  return error_of(images, method, [](const WorldDerivatives& d) -> const Vec3f& { return d.gradient; });
}

DerivativeError hessian_error(const DerivativeImages& images, DerivativeMethod method) {
  return error_of(images, method,
                  [](const WorldDerivatives& d) -> const Eigen::Matrix3f& { return d.hessian; });
}

}  // namespace vrc
