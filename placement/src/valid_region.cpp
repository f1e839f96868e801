// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/valid_region.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace vrc {

RegionAxes hessian_radii(const Jet2& jet, double reference, double epsilon, double gradient_share,
                         double maximum) {
  // |H| + share g g^T / L: where an eigenvalue of H passes through 0 (on the slope of a highlight) the
  // third-order error does not vanish, and the gradient bounds it.
  Eigen::SelfAdjointEigenSolver<Mat2> solver;
  solver.computeDirect(jet.hessian);
  const Mat2 absolute = solver.eigenvectors() * solver.eigenvalues().cwiseAbs().asDiagonal() *
                        solver.eigenvectors().transpose();
  solver.computeDirect(absolute + gradient_share / reference * jet.gradient * jet.gradient.transpose());
  const auto radius = [&](double eigenvalue) {
    const double curvature = std::max(std::abs(eigenvalue), 1e-300);
    return std::min(std::pow(4.0 * epsilon * reference / (kPi * curvature), 0.25), maximum);
  };
  return {solver.eigenvectors().col(0), solver.eigenvectors().col(1), radius(solver.eigenvalues()[0]),
          radius(solver.eigenvalues()[1])};
}

RegionAxes intersection(const RegionAxes& axes, const Vec2& direction, double across, double along) {
  const auto metric = [](const Vec2& axis, double radius) -> Mat2 {
    return axis * axis.transpose() / (radius * radius);
  };
  const Vec2 perpendicular(-direction[1], direction[0]);
  Eigen::SelfAdjointEigenSolver<Mat2> solver;
  solver.computeDirect(metric(axes.axis1, axes.radius1) + metric(axes.axis2, axes.radius2) +
                       metric(direction, across) + metric(perpendicular, along));
  return {solver.eigenvectors().col(0), solver.eigenvectors().col(1),
          1.0 / std::sqrt(solver.eigenvalues()[0]), 1.0 / std::sqrt(solver.eigenvalues()[1])};
}

}  // namespace vrc
