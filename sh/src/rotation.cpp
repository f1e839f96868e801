// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/rotation.h"

#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "sh/basis.h"

namespace vrc::sh {
namespace {

/// Matrix of a band with rows and columns counted from the middle.
class Centred {
 public:
  Centred(const Eigen::MatrixXd& matrix, int l) : matrix_(matrix), l_(l) {}
  double operator()(int m, int n) const { return matrix_(m + l_, n + l_); }

 private:
  const Eigen::MatrixXd& matrix_;
  int l_;
};

/// The step from band l - 1 to band l; names as in [IvanicRuedenberg1996, tables 1 and 2].
struct BandStep {
  Centred r;       ///< Band 1.
  Centred before;  ///< Band l - 1.
  int l;

  double p(int i, int mu, int n) const {
    if (n == l) return r(i, 1) * before(mu, l - 1) - r(i, -1) * before(mu, -l + 1);
    if (n == -l) return r(i, 1) * before(mu, -l + 1) + r(i, -1) * before(mu, l - 1);
    return r(i, 0) * before(mu, n);
  }

  double v(int m, int n) const {
    if (m == 0) return p(1, 1, n) + p(-1, -1, n);
    const double root = std::sqrt(2.0);
    if (m == 1) return root * p(1, 0, n);
    if (m == -1) return root * p(-1, 0, n);
    return m > 0 ? p(1, m - 1, n) - p(-1, 1 - m, n) : p(1, m + 1, n) + p(-1, -m - 1, n);
  }

  double w(int m, int n) const {
    return m > 0 ? p(1, m + 1, n) + p(-1, -m - 1, n) : p(1, m - 1, n) - p(-1, 1 - m, n);
  }

  double entry(int m, int n) const {
    const int a = std::abs(m);
    const double denominator = std::abs(n) == l ? 2.0 * l * (2.0 * l - 1.0) : (l + n) * (l - n);
    // Factors that vanish stand before elements outside the band.
    double sum = 0.0;
    if (a < l) sum += std::sqrt((l + m) * (l - m) / denominator) * p(0, m, n);
    sum += 0.5 * std::sqrt((m == 0 ? 2.0 : 1.0) * (l + a - 1.0) * (l + a) / denominator) *
           (m == 0 ? -1.0 : 1.0) * v(m, n);
    if (m != 0 && a < l - 1) sum -= 0.5 * std::sqrt((l - a - 1.0) * (l - a) / denominator) * w(m, n);
    return sum;
  }
};

Eigen::MatrixXd next_band(const Eigen::MatrixXd& first, const Eigen::MatrixXd& before, int l) {
  const BandStep step{{first, 1}, {before, l - 1}, l};
  Eigen::MatrixXd result(2 * l + 1, 2 * l + 1);
  for (int n = -l; n <= l; ++n) {
    for (int m = -l; m <= l; ++m) result(m + l, n + l) = step.entry(m, n);
  }
  return result;
}

}  // namespace

Rotation::Rotation(int order, const Mat3& rotation) {
  VRC_CHECK(order >= 0 && order <= kMaxOrder, "order {} is not in [0, {}]", order, kMaxOrder);
  VRC_CHECK((rotation.transpose() * rotation).isIdentity(1e-6) && rotation.determinant() > 0.0,
            "the matrix is not a rotation");
  bands_.emplace_back(Eigen::MatrixXd::Ones(1, 1));
  if (order == 0) return;
  constexpr int kAxes[3] = {1, 2, 0};  // Y_1,-1, Y_10, Y_11 are y, z, x.
  Eigen::MatrixXd first(3, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) first(i, j) = rotation(kAxes[i], kAxes[j]);
  }
  bands_.push_back(first);
  for (int l = 2; l <= order; ++l) bands_.push_back(next_band(first, bands_.back(), l));
}

Eigen::MatrixXd Rotation::apply(const Eigen::Ref<const Eigen::MatrixXd>& coefficients) const {
  VRC_CHECK(coefficients.rows() == coefficient_count(order()), "{} coefficients instead of {}",
            coefficients.rows(), coefficient_count(order()));
  Eigen::MatrixXd result(coefficients.rows(), coefficients.cols());
  for (int l = 0; l <= order(); ++l) {
    const int begin = index(l, -l), size = 2 * l + 1;
    result.middleRows(begin, size).noalias() = bands_[l] * coefficients.middleRows(begin, size);
  }
  return result;
}

}  // namespace vrc::sh
