// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/frame_rotator.h"

#include <array>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "sh/basis.h"
#include "sh/rotation.h"

namespace vrc::sh {
namespace {

// The entries of a band, by the reflections in x and y: cosines of even and odd m, then sines. X commutes
// with the reflection in x and takes the one in y to that in z, so it maps each group to exactly one.
constexpr int kGroups = 4;
constexpr int kSine = 2;                                           // Added to the parity of m.
constexpr int kTarget[2][kGroups] = {{0, 2, 1, 3}, {3, 1, 2, 0}};  // For even and odd l.

/// Sixteen entries of each group, m / 2 = 0, 1, ...; the sine of m = 0 has a place as well.
using Groups = std::array<F16, kGroups>;
/// Places of each group that a band reads.
constexpr int place_count(int l) { return l / 2 + 1; }

/// A turn about z: cosine and sine of m times its angle, by the parity of m and then m / 2.
struct Turn {
  std::array<F16, 2> cosine{}, sine{};

  Turn(double c, double s, int order) {
    double cm = 1.0, sm = 0.0;
    for (int m = 0; m <= order; ++m) {
      cosine[m & 1][m >> 1] = static_cast<float>(cm);
      sine[m & 1][m >> 1] = static_cast<float>(sm);
      const double turned = c * cm - s * sm;
      sm = c * sm + s * cm;
      cm = turned;
    }
  }

  /// The entries of band l, whose m = 0 is at `in`, turned. Other places are left as they are, but the
  /// sine of m = 0; the columns of X that read them are zero.
  void apply(int l, const float* in, Groups& g) const {
    for (int m = 0; m <= l; ++m) {
      const float c = cosine[m & 1][m >> 1], s = sine[m & 1][m >> 1];
      g[m & 1][m >> 1] = in[m] * c - in[-m] * s;
      g[kSine + (m & 1)][m >> 1] = in[m] * s + in[-m] * c;
    }
  }

  void apply(Groups& g) const {
    for (int parity = 0; parity < 2; ++parity) {
      const F16 c = g[parity], s = g[kSine + parity];
      g[parity] = c * cosine[parity] - s * sine[parity];
      g[kSine + parity] = c * sine[parity] + s * cosine[parity];
    }
  }
};

/// X times the groups of band l by the band's columns.
Groups apply_x(int l, const Groups& in, const F16* column) {
  Groups sum{};
  for (int k = 0; k < place_count(l); ++k) {
    for (int group = 0; group < kGroups; ++group) sum[group] += in[group][k] * *column++;
  }
  const auto& target = kTarget[l & 1];
  Groups out;
  for (int group = 0; group < kGroups; ++group) out[target[group]] = sum[group];
  return out;
}

/// The three turns about z; see FrameRotator.
struct Turns {
  Turn first, second, third;
};

Turns turns_of(const Frame& f, int order) {
  const double sine = std::hypot(f.normal.x(), f.normal.y());
  const double ca = sine > 0.0 ? f.normal.x() / sine : 1.0, sa = sine > 0.0 ? f.normal.y() / sine : 0.0;
  // Turned back by a, the y of tangent and bitangent are sin c and cos c, wherever the normal points.
  const double sc = ca * f.tangent.y() - sa * f.tangent.x();
  const double cc = ca * f.bitangent.y() - sa * f.bitangent.x();
  return {{cc, sc, order}, {-f.normal.z(), -sine, order}, {-ca, -sa, order}};
}

/// m of place k of a group, or nothing where band l has no such entry.
std::optional<int> entry_m(int l, int group, int k) {
  const int m = 2 * k + (group & 1);
  if (m > l || (group == kSine && k == 0)) return std::nullopt;
  return group >= kSine ? -m : m;
}

/// Column of the block of X that reads place k of a group; zero where there is no entry.
F16 column_of(const Eigen::MatrixXd& band, int l, int group, int k) {
  F16 column{};
  for (int i = 0; i < place_count(l); ++i) {
    const auto from = entry_m(l, group, k), to = entry_m(l, kTarget[l & 1][group], i);
    if (from && to) column[i] = static_cast<float>(band(l + *to, l + *from));
  }
  return column;
}

}  // namespace

FrameRotator::FrameRotator(int order) : order_(order) {
  VRC_CHECK(order >= 0 && order <= kMaxFrameOrder, "order {} is not in [0, {}]", order, kMaxFrameOrder);
  const Mat3 x = (Mat3() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
  const Rotation rotation(order, x);
  for (int l = 0; l <= order; ++l) {
    for (int k = 0; k < place_count(l); ++k) {
      for (int group = 0; group < kGroups; ++group)
        columns_.push_back(column_of(rotation.band(l), l, group, k));
    }
  }
}

void FrameRotator::rotate(const Frame& frame, const Eigen::Ref<const Eigen::MatrixXf>& local,
                          Eigen::Ref<Eigen::MatrixXf> world) const {
  const int rows = coefficient_count(order_);
  VRC_CHECK(local.rows() == rows && world.rows() == rows && local.cols() == world.cols(),
            "{} x {} coefficients to {} x {}, order {}", local.rows(), local.cols(), world.rows(),
            world.cols(), order_);
  const Turns turns = turns_of(frame, order_);
  for (Eigen::Index channel = 0; channel < local.cols(); ++channel) {
    const F16* columns = columns_.data();
    Groups turned{};
    for (int l = 0; l <= order_; ++l) {
      turns.first.apply(l, local.col(channel).data() + index(l, 0), turned);
      Groups g = apply_x(l, turned, columns);
      turns.second.apply(g);
      g = apply_x(l, g, columns);
      turns.third.apply(g);
      columns += kGroups * place_count(l);
      float* out = world.col(channel).data() + index(l, 0);
      for (int m = l; m >= 0; --m) {
        out[-m] = g[kSine + (m & 1)][m >> 1];
        out[m] = g[m & 1][m >> 1];  // Second: for m = 0 both are one place.
      }
    }
  }
}

Frame transposed(const Frame& f) {
  return {{f.tangent.x(), f.bitangent.x(), f.normal.x()},
          {f.tangent.y(), f.bitangent.y(), f.normal.y()},
          {f.tangent.z(), f.bitangent.z(), f.normal.z()}};
}

}  // namespace vrc::sh
