// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/valid_region.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace vrc {

RegionAxes hessian_radii(const Jet2& jet, double reference, double epsilon, double gradient_share,
                         const RadiusLimits& limits) {
  // |H| + share g g^T / L: where an eigenvalue of H passes through 0 (on the slope of a highlight) the
  // third-order error does not vanish, and the gradient bounds it.
  Eigen::SelfAdjointEigenSolver<Mat2> solver;
  solver.computeDirect(jet.hessian);
  const Mat2 absolute = solver.eigenvectors() * solver.eigenvalues().cwiseAbs().asDiagonal() * solver.eigenvectors().transpose();
  solver.computeDirect(absolute + gradient_share / reference * jet.gradient * jet.gradient.transpose());
  const auto radius = [&](double eigenvalue) {
    const double curvature = std::max(std::abs(eigenvalue), 1e-300);
    const double r = std::pow(4.0 * epsilon * reference / (kPi * curvature), 0.25);
    return std::clamp(r, limits.minimum, std::max(limits.minimum, limits.maximum));
  };
  return {solver.eigenvectors().col(0), solver.eigenvectors().col(1), radius(solver.eigenvalues()[0]),
          radius(solver.eigenvalues()[1])};
}

}  // namespace vrc
