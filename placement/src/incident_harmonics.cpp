// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/incident_harmonics.h"

#include <vector>

#include "gather_rays.h"

namespace vrc {
namespace {

constexpr int kBatchPackets = 8;
constexpr int kBatch = kBatchPackets * kLanes;

// Factors of Y that are summed over the rays, three channels each. v, g, h are the incident radiance times
// the geometry term with its derivatives, t the distance.
enum BaseFactor { kV, kG1, kG2, kH11, kH12, kH22, kBaseFactors };
enum DividedFactor { kVt, kG1t, kG2t, kDividedFactors };  // read by first derivatives of Y
enum TwiceDividedFactor { kVtt, kTwiceDividedFactors };   // by second ones

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Sixteen-wide rows of a matrix whose columns are the rays of a batch.
class BatchRows {
 public:
  explicit BatchRows(int rows) : packets_(static_cast<std::size_t>(rows * kBatchPackets)) {}

  F16& at(int row, int packet) { return packets_[static_cast<std::size_t>(row * kBatchPackets + packet)]; }
  std::span<F16> from(int packet) { return std::span(packets_).subspan(static_cast<std::size_t>(packet)); }
  void set(int factor, int packet, const V3x16& v) {
    at(3 * factor, packet) = v.x;
    at(3 * factor + 1, packet) = v.y;
    at(3 * factor + 2, packet) = v.z;
  }
  [[nodiscard]] Eigen::Map<const RowMatrix> matrix() const {
    return {reinterpret_cast<const float*>(packets_.data()),
            static_cast<Eigen::Index>(packets_.size()) / kBatchPackets, kBatch};
  }

 private:
  std::vector<F16> packets_;
};

}  // namespace

/// Sums over rays: columns are factors, three channels each. First derivatives of Y read one order more,
/// second ones two.
struct HarmonicsGatherer::Moments {
  Eigen::MatrixXf base, divided, twice_divided;

  explicit Moments(int order)
      : base(Eigen::MatrixXf::Zero(sh::coefficient_count(order), 3 * kBaseFactors)),
        divided(Eigen::MatrixXf::Zero(sh::coefficient_count(order + 1), 3 * kDividedFactors)),
        twice_divided(Eigen::MatrixXf::Zero(sh::coefficient_count(order + 2), 3 * kTwiceDividedFactors)) {}
};

namespace {

/// A batch of rays with the factors of their sums.
struct Batch {
  BatchRows basis, base{3 * kBaseFactors}, divided{3 * kDividedFactors},
      twice_divided{3 * kTwiceDividedFactors};
  int packets = 0;

  explicit Batch(int coefficients) : basis(coefficients) {}

  void set_factors(const GatherPacket16& packet) {
    const MovingPoint16& p = packet.moving;
    // The solid angle of the surface element at the hit: s / |r|^3, s = -n_y . r.
    const UnitJet16 geometry = packet.facing * pow(p.jet_rr, -1.5f);
    RgbJet16 f;
    const F16 w = packet.inverse_density;
    f.add_product({w, w, w}, geometry, packet.incident);
    const F16 inverse = 1.0f / sqrt(p.rr);
    const V3x16 v = f.value * inverse;
    base.set(kV, packets, f.value);
    base.set(kG1, packets, f.g1);
    base.set(kG2, packets, f.g2);
    base.set(kH11, packets, f.h11);
    base.set(kH12, packets, f.h12);
    base.set(kH22, packets, f.h22);
    divided.set(kVt, packets, v);
    divided.set(kG1t, packets, f.g1 * inverse);
    divided.set(kG2t, packets, f.g2 * inverse);
    twice_divided.set(kVtt, packets, v * inverse);
  }

  void clear_factors(int packet) {
    for (int row = 0; row < 3 * kBaseFactors; ++row) base.at(row, packet) = F16{};
    for (int row = 0; row < 3 * kDividedFactors; ++row) divided.at(row, packet) = F16{};
    for (int row = 0; row < 3 * kTwiceDividedFactors; ++row) twice_divided.at(row, packet) = F16{};
  }
};

}  // namespace

HarmonicsGatherer::HarmonicsGatherer(int order)
    : order_(order), basis_(order + 2), once_(order), twice_(order + 1) {}

IncidentHarmonics HarmonicsGatherer::gather(const Scene& scene, const RecordSite& site,
                                            const GatherOptions& options, RayCounts& counts,
                                            HitDistances& hits) const {
  GatherRays rays(scene, site, options, counts);
  Moments moments(order_);
  Batch batch(basis_.size());
  const auto flush = [&] {
    for (int k = batch.packets; k < kBatchPackets; ++k) batch.clear_factors(k);
    const auto y = batch.basis.matrix();
    moments.base.noalias() += y.topRows(moments.base.rows()) * batch.base.matrix().transpose();
    moments.divided.noalias() += y.topRows(moments.divided.rows()) * batch.divided.matrix().transpose();
    moments.twice_divided.noalias() += y * batch.twice_divided.matrix().transpose();
    batch.packets = 0;
  };
  rays.for_each_packet([&](const GatherPacket16& packet) {
    batch.set_factors(packet);
    basis_.evaluate(packet.direction, batch.basis.from(batch.packets), kBatchPackets);
    if (++batch.packets == kBatchPackets) flush();
  });
  if (batch.packets > 0) flush();
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
  const Eigen::MatrixXd divided = moments.divided.cast<double>();
  const Eigen::MatrixXd twice_divided = moments.twice_divided.cast<double>();
  Eigen::MatrixXd first[3], inner[3];
  for (std::size_t i = 0; i < 3; ++i) {
    first[i] = once_.differentiate[i] * divided;
    inner[i] = twice_.differentiate[i] * twice_divided - twice_.multiply[i] * twice_divided;
  }
  // First derivatives of Y along the frame's axes in the moments v, g1 and g2: columns as in `divided`.
  const Eigen::MatrixXd along_axis[3] = {along(0, first), along(1, first), along(2, first)};
  const auto moved = [&](int factor, int axis) { return along_axis[axis].middleCols(3 * factor, 3); };
  const auto base = [&](int factor) -> Eigen::MatrixXd {
    return moments.base.middleCols(3 * factor, 3).cast<double>();
  };
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
  IncidentHarmonics result;
  result.coefficients.resize(Eigen::NoChange, count);
  for (int k = 0; k < IncidentHarmonics::kEntries; ++k) {
    for (int c = 0; c < 3; ++c) {
      result.coefficients.row(IncidentHarmonics::kEntries * c + k) =
          (entries[k].col(c) / rays).transpose().cast<float>();
    }
  }
  return result;
}

std::array<Jet2, 3> outgoing_radiance(const IncidentHarmonics& incident,
                                      const Eigen::Ref<const Eigen::MatrixXf>& weights) {
  std::array<Jet2, 3> result;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Matrix<double, IncidentHarmonics::kEntries, 1> v =
        (incident.coefficients.middleRows<IncidentHarmonics::kEntries>(IncidentHarmonics::kEntries * c) *
         weights.col(c))
            .cast<double>();
    Jet2& jet = result[static_cast<std::size_t>(c)];
    jet.value = v[0];
    jet.gradient = {v[1], v[2]};
    jet.hessian << v[3], v[4], v[4], v[5];
  }
  return result;
}

}  // namespace vrc
