// SPDX-License-Identifier: GPL-3.0-or-later
#include "sh/frame_rotator.h"

#include <array>
#include <cmath>

#include "core/error.h"
#include "sh/basis.h"
#include "sh/rotation.h"

namespace vrc::sh {
namespace {

// The entries of a band, by the reflections in x and y. X commutes with the one in x and takes the one
// in y to that in z, so it maps each group to exactly one group.
enum Group { kEvenCosine, kOddCosine, kEvenSine, kOddSine, kGroups };
constexpr Group kTarget[2][kGroups] = {{kEvenCosine, kEvenSine, kOddCosine, kOddSine},   // l even
                                       {kOddSine, kOddCosine, kEvenSine, kEvenCosine}};  // l odd

constexpr bool is_odd(int group) { return group == kOddCosine || group == kOddSine; }
constexpr bool is_sine(int group) { return group >= kEvenSine; }
/// |m| of entry k of a group.
constexpr int absolute_m(int group, int k) { return 2 * k + (is_odd(group) ? 1 : 0); }
/// m of entry k; the sine of m = 0 has a place, whose row and column are zero.
constexpr int signed_m(int group, int k) {
  return is_sine(group) ? -absolute_m(group, k) : absolute_m(group, k);
}
/// Entries of a group in band l.
constexpr int entry_count(int group, int l) { return is_odd(group) ? (l + 1) / 2 : l / 2 + 1; }

using Groups = std::array<F16, kGroups>;

/// Cosine and sine of m times an angle, for |m| = 0 .. kMaxFrameOrder.
struct Turn {
  alignas(64) std::array<float, 2 * kLanes> cosine, sine;
  F16 even_cosine, even_sine, odd_cosine, odd_sine;

  Turn(double c, double s, int order)
      : cosine{}, sine{}, even_cosine{}, even_sine{}, odd_cosine{}, odd_sine{} {
    double cm = 1.0, sm = 0.0;
    for (int m = 0; m <= order; ++m) {
      cosine[m] = static_cast<float>(cm);
      sine[m] = static_cast<float>(sm);
      const double turned = c * cm - s * sm;
      sm = c * sm + s * cm;
      cm = turned;
    }
    for (int k = 0; k < kLanes; ++k) {
      even_cosine[k] = cosine[2 * k];
      even_sine[k] = sine[2 * k];
      odd_cosine[k] = cosine[2 * k + 1];
      odd_sine[k] = sine[2 * k + 1];
    }
  }

  void apply(Groups& g) const {
    const F16 even = g[kEvenCosine], odd = g[kOddCosine];
    g[kEvenCosine] = even * even_cosine - g[kEvenSine] * even_sine;
    g[kEvenSine] = even * even_sine + g[kEvenSine] * even_cosine;
    g[kOddCosine] = odd * odd_cosine - g[kOddSine] * odd_sine;
    g[kOddSine] = odd * odd_sine + g[kOddSine] * odd_cosine;
  }
};

/// X times the groups of band l, whose entries `in` yields; advances `column` to the next band.
template <typename Entry>
Groups apply_x(int l, const Entry& in, const F16*& column) {
  Groups out;
  for (int group = 0; group < kGroups; ++group) {
    F16 sum{};
    const int count = entry_count(group, l);
    for (int k = 0; k < count; ++k) sum += in(group, k) * *column++;
    out[kTarget[l & 1][group]] = sum;
  }
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

}  // namespace

FrameRotator::FrameRotator(int order) : order_(order) {
  VRC_CHECK(order >= 0 && order <= kMaxFrameOrder, "order {} is not in [0, {}]", order, kMaxFrameOrder);
  const Mat3 x = (Mat3() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
  const Rotation rotation(order, x);
  for (int l = 0; l <= order; ++l) {
    for (int group = 0; group < kGroups; ++group) {
      const int target = kTarget[l & 1][group];
      for (int k = 0; k < entry_count(group, l); ++k) {
        F16 column{};
        for (int i = 0; i < entry_count(target, l); ++i) {
          const bool placeholder = (group == kEvenSine && k == 0) || (target == kEvenSine && i == 0);
          if (!placeholder)
            column[i] = static_cast<float>(rotation.band(l)(l + signed_m(target, i), l + signed_m(group, k)));
        }
        columns_.push_back(column);
      }
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
    const float* in = local.col(channel).data();
    float* out = world.col(channel).data();
    const F16* column = columns_.data();
    for (int l = 0; l <= order_; ++l) {
      in += l == 0 ? 0 : 2 * l;  // To m = 0 of the band.
      out += l == 0 ? 0 : 2 * l;
      const F16* columns = column;
      Groups g = apply_x(
          l,
          [&](int group, int k) {
            const int m = absolute_m(group, k);
            const float c = turns.first.cosine[m], s = turns.first.sine[m];
            return is_sine(group) ? in[m] * s + in[-m] * c : in[m] * c - in[-m] * s;
          },
          column);
      turns.second.apply(g);
      g = apply_x(
          l, [&](int group, int k) { return g[group][k]; }, columns);
      turns.third.apply(g);
      for (int group = kGroups - 1; group >= 0; --group) {  // Last the cosine of m = 0.
        const int count = entry_count(group, l);
        for (int k = 0; k < count; ++k) out[signed_m(group, k)] = g[group][k];
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
