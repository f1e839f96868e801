// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/derivatives.h"

#include <cmath>
#include <cstdlib>

#include "core/error.h"

namespace vrc::sh {
namespace {

// With C_lm + i S_lm = (l - m)! P_l^m(cos theta) e^(i m phi) / r^(l+1), m >= 0, the ladder is
//   (d/dx + i d/dy) (C + i S)_lm = -(C + i S)_(l+1)(m+1)
//   (d/dx - i d/dy) (C + i S)_lm = +(C + i S)_(l+1)(m-1), m > 0
//   d/dz (C + i S)_lm = -(C + i S)_(l+1)m.
// Y_lm / r^(l+1) is e_m sqrt((2l + 1) / (4 pi (l - m)! (l + m)!)) times C or S, e_0 = 1, else sqrt(2).

/// From the row of (l, m) to (l + 1, m'), m and m' >= 0: the quotient of the two normalisations.
double quotient(int l, int m, int raised_m) {
  const double factorials = raised_m > m   ? (l + m + 1.0) * (l + m + 2.0)
                            : raised_m < m ? (l - m + 1.0) * (l - m + 2.0)
                                           : (l + 1.0 + m) * (l + 1.0 - m);
  const double e = (m == 0 ? 1.0 : std::sqrt(2.0)) / (raised_m == 0 ? 1.0 : std::sqrt(2.0));
  return e * std::sqrt((2.0 * l + 1.0) / (2.0 * l + 3.0) * factorials);
}

/// A term of the row (l, m) that reads the cosine (sign 1) or sine (sign -1) of m'; none if m' < 0, and
/// S_l0 is zero.
RaisedTerm term(int l, int m, int raised_m, int sign, double factor) {
  if (raised_m < 0 || (raised_m == 0 && sign < 0)) return {index(l + 1, 0), 0.0};
  return {index(l + 1, sign * raised_m), factor * quotient(l, m, raised_m)};
}

std::array<std::array<RaisedTerm, 2>, 3> row(int l, int signed_m) {
  const int m = std::abs(signed_m);
  const int kind = signed_m >= 0 ? 1 : -1;  // Reads its own kind along x and z, the other along y.
  const double half = m == 0 ? 1.0 : 0.5;
  return {{{term(l, m, m - 1, kind, half), term(l, m, m + 1, kind, -half)},
           {term(l, m, m - 1, -kind, -kind * half), term(l, m, m + 1, -kind, -kind * half)},
           {term(l, m, m, kind, -1.0), term(l, m, -1, kind, 0.0)}}};
}

constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

}  // namespace

RaisingOperators::RaisingOperators(int order) : order_(order) {
  VRC_CHECK(order >= 0 && order < kMaxOrder, "order {} is not in [0, {})", order, kMaxOrder);
  for (int l = 0; l <= order; ++l) {
    for (int m = -l; m <= l; ++m) rows_.push_back(row(l, m));
  }
}

Eigen::MatrixXd RaisingOperators::apply(int axis, const Eigen::Ref<const Eigen::MatrixXd>& raised) const {
  VRC_CHECK(axis >= 0 && axis < 3, "axis {}", axis);
  VRC_CHECK(raised.rows() == coefficient_count(order_ + 1), "{} coefficients instead of {}", raised.rows(),
            coefficient_count(order_ + 1));
  Eigen::MatrixXd result(coefficient_count(order_), raised.cols());
  for (Eigen::Index column = 0; column < raised.cols(); ++column) {
    for (int j = 0; j < result.rows(); ++j) {
      const auto& [a, b] = rows_[j][axis];
      result(j, column) = a.factor * raised(a.index, column) + b.factor * raised(b.index, column);
    }
  }
  return result;
}

DerivativeBasis::DerivativeBasis(int order) : basis_(order + 2), raising_(order + 1) {
  VRC_CHECK(order >= 0, "order {} is negative", order);
}

BasisJets DerivativeBasis::evaluate(const Vec3& d) const {
  Eigen::VectorXd y(basis_.size());
  basis_.evaluate(d, {y.data(), static_cast<std::size_t>(y.size())});
  // Derivatives of I_lm: the first of order + 1, the second of order.
  Eigen::Matrix<double, Eigen::Dynamic, 3> first(coefficient_count(raising_.order()), 3);
  for (int axis = 0; axis < 3; ++axis) first.col(axis) = raising_.apply(axis, y);

  const int order = basis_.order() - 2;
  const int count = coefficient_count(order);
  BasisJets jets{y.head(count), first.topRows(count), {count, 6}};
  for (int l = 0; l <= order; ++l) {
    for (int j = index(l, -l); j <= index(l, l); ++j) {
      // Y = r^(l+1) I differentiated at r = 1.
      const double k = l + 1.0;
      for (int pair = 0; pair < 6; ++pair) {
        const auto [a, b] = kPairs[pair];
        const auto& [s, t] = raising_.terms(j, a);
        jets.hessian(j, pair) = s.factor * first(s.index, b) + t.factor * first(t.index, b) +
                                k * (d[a] * first(j, b) + d[b] * first(j, a)) +
                                k * ((a == b ? 1.0 : 0.0) + (k - 2.0) * d[a] * d[b]) * y[j];
      }
      jets.gradient.row(j) += k * y[j] * d.transpose();
    }
  }
  return jets;
}

}  // namespace vrc::sh
