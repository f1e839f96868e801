// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/incident_harmonics.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "gather_rays.h"
#include "sh/basis.h"

namespace vrc {
namespace {

// Factors of Y that are summed over the rays, three channels each. v, g, h are the incident radiance times
// the geometry term with its derivatives, t the distance. First derivatives of Y read those divided by t,
// second ones those divided by t^2.
enum Factor { kV, kG1, kG2, kH11, kH12, kH22, kVt, kG1t, kG2t, kVtt, kFactors };
constexpr int kColumns = sh::ScatteredSums::kValues;  // the channels of all factors
// and the luminance of v with the signs of two halves of the lanes, each lane being a batch of its own.
constexpr int kNoiseColumn = 3 * kFactors, kNoiseColumns = HarmonicsGatherer::NoiseSums::ColsAtCompileTime;
static_assert(kNoiseColumn + kNoiseColumns == kColumns);

using Values = sh::ScatteredSums::Values;

/// The factors of sixteen rays.
class Factors {
 public:
  explicit Factors(const GatherPacket16& packet) {
    const MovingPoint16& p = packet.moving;
    // The solid angle of the surface element at the hit: s / |r|^3, s = -n_y . r.
    const UnitJet16 geometry = packet.facing * pow(p.jet_rr, -1.5f);
    const F16 w = packet.inverse_density;
    const RgbJet16 f = product({w, w, w}, geometry, packet.incident);
    const F16 inverse = 1.0f / sqrt(p.rr);
    const V3x16 v = f.value * inverse;
    set(kV, f.value);
    set(kG1, f.jet.g1);
    set(kG2, f.jet.g2);
    set(kH11, f.jet.h11);
    set(kH12, f.jet.h12);
    set(kH22, f.jet.h22);
    set(kVt, v);
    set(kG1t, f.jet.g1 * inverse);
    set(kG2t, f.jet.g2 * inverse);
    set(kVtt, v * inverse);
    const F16 noise = luminance(f.value);
    const I16 lane = lane_index();
    set_column(kNoiseColumn, select((lane & 1) == 0, noise, -noise));
    set_column(kNoiseColumn + 1, select((lane & 2) == 0, noise, -noise));
  }

  [[nodiscard]] std::span<const Values, kLanes> of_rays() const { return rays_; }

 private:
  void set(int factor, const V3x16& v) {
    set_column(3 * factor, v.x);
    set_column(3 * factor + 1, v.y);
    set_column(3 * factor + 2, v.z);
  }
  void set_column(int column, F16 v) {
    float* const first = reinterpret_cast<float*>(rays_.data()) + column;
    for (int lane = 0; lane < kLanes; ++lane) first[lane * kColumns] = v[lane];
  }

  std::array<Values, kLanes> rays_;
};

}  // namespace

/// Sums of factors over rays: a row for each coefficient.
class HarmonicsGatherer::Moments {
 public:
  explicit Moments(std::vector<Values> rows) : rows_(std::move(rows)) {}

  [[nodiscard]] Eigen::MatrixXd of(int first_factor, int factors, int order) const {
    return columns(3 * first_factor, 3 * factors, order);
  }
  [[nodiscard]] Eigen::MatrixXd columns(int first, int count, int order) const {
    using Floats = Eigen::Matrix<float, Eigen::Dynamic, kColumns, Eigen::RowMajor>;
    const Eigen::Map<const Floats> all(reinterpret_cast<const float*>(rows_.data()), std::ssize(rows_),
                                       kColumns);
    return all.block(0, first, sh::coefficient_count(order), count).cast<double>();
  }

 private:
  std::vector<Values> rows_;
};

IncidentHarmonics::IncidentHarmonics(const Coefficients& coefficients)
    : count_(static_cast<int>(coefficients.cols())) {
  constexpr float kMost = std::numeric_limits<std::int16_t>::max();
  rounded_.resize(place(3 * kEntries, 0));
  for (int entry = 0; entry < 3 * kEntries; ++entry) {
    const float largest = count_ > 0 ? coefficients.row(entry).cwiseAbs().maxCoeff() : 0.0f;
    if (!(largest > 0.0f)) continue;
    scale_[static_cast<std::size_t>(entry)] = largest / kMost;
    for (int j = 0; j < count_; ++j) {
      rounded_[place(entry, j)] =
          static_cast<std::int16_t>(std::lround(coefficients(entry, j) / largest * kMost));
    }
  }
}

std::size_t IncidentHarmonics::place(int entry, int j) const {
  const int packets = (count_ + kLanes - 1) / kLanes;
  const int packet = (entry / kEntries * packets + j / kLanes) * kEntries + entry % kEntries;
  return static_cast<std::size_t>(packet * kLanes + j % kLanes);
}

IncidentHarmonics::Coefficients IncidentHarmonics::coefficients() const {
  Coefficients result(3 * kEntries, count_);
  for (int entry = 0; entry < 3 * kEntries; ++entry) {
    for (int j = 0; j < count_; ++j)
      result(entry, j) =
          scale_[static_cast<std::size_t>(entry)] * static_cast<float>(rounded_[place(entry, j)]);
  }
  return result;
}

Eigen::Matrix<float, IncidentHarmonics::kEntries, 1> IncidentHarmonics::weighted(int c,
                                                                                 const float* weights) const {
  F16 sum[kEntries] = {};
  const std::int16_t* rounded = rounded_.data() + place(kEntries * c, 0);
  for (int j = 0; j < count_; j += kLanes) {
    F16 w{};
    std::memcpy(&w, weights + j, sizeof(float) * static_cast<std::size_t>(std::min(kLanes, count_ - j)));
    for (F16& s : sum) {
      s += w * load_shorts(rounded);
      rounded += kLanes;
    }
  }
  Eigen::Matrix<float, kEntries, 1> result;
  for (int k = 0; k < kEntries; ++k)
    result[k] = scale_[static_cast<std::size_t>(kEntries * c + k)] * lane_sum(sum[k]);
  return result;
}

HarmonicsGatherer::HarmonicsGatherer(int order)
    : order_(order), sums_(order + 2), once_(order), twice_(order + 1) {}

IncidentHarmonics HarmonicsGatherer::gather(const Scene& scene, const RecordSite& site,
                                            const GatherOptions& options, RayCounts& counts,
                                            HitDistances& hits, NoiseSums* noise) const {
  GatherRays rays(scene, site, options, counts);
  static thread_local sh::ScatteredSums::Grid grid;  // storage only: emptied for every record
  sums_.clear(grid);
  rays.for_each_packet([&](const GatherPacket16& packet) {
    sums_.add(packet.inverse_density > 0.0f, packet.direction, Factors(packet).of_rays(), grid);
  });
  const Moments moments(sums_.sums(grid));
  if (noise != nullptr) {
    *noise = moments.columns(kNoiseColumn, kNoiseColumns, order_).cast<float>() /
             static_cast<float>(rays.ray_count());
  }
  rays.describe_hits(hits);
  return finish(moments, site.frame, followed_shape_operator(site, options), rays.ray_count());
}

IncidentHarmonics HarmonicsGatherer::finish(const Moments& moments, const Frame& frame, const Mat2& s,
                                            double rays) const {
  const int count = sh::coefficient_count(order_);
  Mat3 axes;  // rows
  axes << frame.tangent.transpose(), frame.bitangent.transpose(), frame.normal.transpose();

  // Along an axis of the record's frame, from those of the world.
  const auto along = [&](int axis, const Eigen::MatrixXd(&world)[3]) -> Eigen::MatrixXd {
    return axes(axis, 0) * world[0] + axes(axis, 1) * world[1] + axes(axis, 2) * world[2];
  };
  const Eigen::MatrixXd divided = moments.of(kVt, 3, order_ + 1);
  const Eigen::MatrixXd twice_divided = moments.of(kVtt, 1, order_ + 2);
  Eigen::MatrixXd first[3], inner[3];
  for (std::size_t i = 0; i < 3; ++i) {
    first[i] = once_.differentiate[i] * divided;
    inner[i] = twice_.differentiate[i] * twice_divided - twice_.multiply[i] * twice_divided;
  }
  // First derivatives of Y along the frame's axes in the moments v, g1 and g2: columns as in `divided`.
  const Eigen::MatrixXd along_axis[3] = {along(0, first), along(1, first), along(2, first)};
  const auto moved = [&](int factor, int axis) { return along_axis[axis].middleCols(3 * (factor - kVt), 3); };
  const auto base = [&](int factor) { return moments.of(factor, 1, order_); };
  const auto second = [&](int a, int b) -> Eigen::MatrixXd {
    const Eigen::MatrixXd along_b = along(b, inner);
    Eigen::MatrixXd world[3];
    for (std::size_t i = 0; i < 3; ++i) world[i] = once_.differentiate[i] * along_b;
    return along(a, world);
  };
  // Hits stay where they are: the direction to them moves by -d and, bending with the surface, by
  // n (d^T S d) / 2.
  const auto hessian = [&](int factor, int a, int b) -> Eigen::MatrixXd {
    return base(factor) - moved(kG1t + a, b) - moved(kG1t + b, a) + second(a, b) + s(a, b) * moved(kVt, 2);
  };
  const Eigen::MatrixXd entries[IncidentHarmonics::kEntries] = {base(kV),
                                                                base(kG1) - moved(kVt, 0),
                                                                base(kG2) - moved(kVt, 1),
                                                                hessian(kH11, 0, 0),
                                                                hessian(kH12, 0, 1),
                                                                hessian(kH22, 1, 1)};
  IncidentHarmonics::Coefficients result(3 * IncidentHarmonics::kEntries, count);
  for (int k = 0; k < IncidentHarmonics::kEntries; ++k) {
    for (int c = 0; c < 3; ++c) {
      result.row(IncidentHarmonics::kEntries * c + k) = (entries[k].col(c) / rays).transpose().cast<float>();
    }
  }
  return IncidentHarmonics(result);
}

std::array<Jet2, 3> outgoing_radiance(const IncidentHarmonics& incident,
                                      const Eigen::Ref<const Eigen::MatrixXf>& weights) {
  std::array<Jet2, 3> result;
  for (int c = 0; c < 3; ++c) {
    const auto v = incident.weighted(c, weights.col(c).data()).cast<double>().eval();
    Jet2& jet = result[static_cast<std::size_t>(c)];
    jet.value = v[0];
    jet.gradient = {v[1], v[2]};
    jet.hessian << v[3], v[4], v[4], v[5];
  }
  return result;
}

}  // namespace vrc
