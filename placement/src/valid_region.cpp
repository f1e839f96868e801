// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/valid_region.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace vrc {

RegionAxes hessian_radii(const Mat2& hessian, double reference, double epsilon, const RadiusLimits& limits) {
  Eigen::SelfAdjointEigenSolver<Mat2> solver;
  solver.computeDirect(hessian);
  const auto radius = [&](double eigenvalue) {
    const double curvature = std::max(std::abs(eigenvalue), 1e-300);
    const double r = std::pow(4.0 * epsilon * reference / (kPi * curvature), 0.25);
    return std::clamp(r, limits.minimum, std::max(limits.minimum, limits.maximum));
  };
  return {solver.eigenvectors().col(0), solver.eigenvectors().col(1), radius(solver.eigenvalues()[0]),
          radius(solver.eigenvalues()[1])};
}

}  // namespace vrc
