// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/incident_harmonics.h"

#include <vector>

#include "gather_rays.h"

namespace vrc {
namespace {

constexpr int kBatchPackets = 8;
constexpr int kBatch = kBatchPackets * kLanes;

// Factors of Y that are summed over the rays, three channels each. v, g, h are the incident radiance times
// the geometry term with its derivatives; r is the unit direction in the record's frame, t the distance.
enum BaseFactor {
  kV,
  kG1,
  kG2,
  kH11,
  kH12,
  kH22,
  kVr1,
  kVr2,
  kVrn,
  kGr11,
  kGr12,
  kGr22,
  kVrr11,
  kVrr12,
  kVrr22,
  kBaseFactors
};
enum RaisedFactor { kVt, kG1t, kG2t, kVr1t, kVr2t, kRaisedFactors };
enum TwiceRaisedFactor { kVtt, kTwiceRaisedFactors };

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

/// Sums over rays: columns are factors, three channels each.
struct HarmonicsGatherer::Moments {
  Eigen::MatrixXf base, raised, twice_raised;

  explicit Moments(int order)
      : base(Eigen::MatrixXf::Zero(sh::coefficient_count(order), 3 * kBaseFactors)),
        raised(Eigen::MatrixXf::Zero(sh::coefficient_count(order + 1), 3 * kRaisedFactors)),
        twice_raised(Eigen::MatrixXf::Zero(sh::coefficient_count(order + 2), 3 * kTwiceRaisedFactors)) {}
};

namespace {

/// A batch of rays with the factors of their sums.
struct Batch {
  BatchRows basis, base{3 * kBaseFactors}, raised{3 * kRaisedFactors}, twice_raised{3 * kTwiceRaisedFactors};
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
    const F16 r1 = p.r1 * inverse, r2 = p.r2 * inverse, rn = p.nr * inverse;
    const V3x16 v = f.value * inverse, vv = v * inverse;
    const V3x16 g1 = f.g1 * inverse, g2 = f.g2 * inverse;
    const int k = packets;
    base.set(kV, k, f.value);
    base.set(kG1, k, f.g1);
    base.set(kG2, k, f.g2);
    base.set(kH11, k, f.h11);
    base.set(kH12, k, f.h12);
    base.set(kH22, k, f.h22);
    base.set(kVr1, k, v * r1);
    base.set(kVr2, k, v * r2);
    base.set(kVrn, k, v * rn);
    base.set(kGr11, k, g1 * (2.0f * r1));
    base.set(kGr12, k, g1 * r2 + g2 * r1);
    base.set(kGr22, k, g2 * (2.0f * r2));
    base.set(kVrr11, k, vv * (r1 * r1));
    base.set(kVrr12, k, vv * (r1 * r2));
    base.set(kVrr22, k, vv * (r2 * r2));
    raised.set(kVt, k, v);
    raised.set(kG1t, k, g1);
    raised.set(kG2t, k, g2);
    raised.set(kVr1t, k, vv * r1);
    raised.set(kVr2t, k, vv * r2);
    twice_raised.set(kVtt, k, vv);
  }

  void clear_factors(int packet) {
    for (int row = 0; row < 3 * kBaseFactors; ++row) base.at(row, packet) = F16{};
    for (int row = 0; row < 3 * kRaisedFactors; ++row) raised.at(row, packet) = F16{};
    for (int row = 0; row < 3 * kTwiceRaisedFactors; ++row) twice_raised.at(row, packet) = F16{};
  }
};

/// Columns 3 factor + channel, for all three channels.
Eigen::MatrixXd columns(const Eigen::MatrixXf& moments, int factor) {
  return moments.middleCols(3 * factor, 3).cast<double>();
}

}  // namespace

HarmonicsGatherer::HarmonicsGatherer(int order)
    : order_(order), basis_(order + 2), raise_(order), raise_again_(order + 1) {}

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
    moments.raised.noalias() += y.topRows(moments.raised.rows()) * batch.raised.matrix().transpose();
    moments.twice_raised.noalias() += y * batch.twice_raised.matrix().transpose();
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
  const Vec3 axes[3] = {frame.tangent, frame.bitangent, frame.normal};
  const int count = sh::coefficient_count(order_);
  Eigen::VectorXd p(count);
  for (int l = 0; l <= order_; ++l) p.segment(l * l, 2 * l + 1).setConstant(l + 1.0);

  // A along an axis of the record's frame.
  const auto raise = [&](const sh::RaisingOperators& raising, int axis,
                         const Eigen::MatrixXd& sums) -> Eigen::MatrixXd {
    return axes[axis][0] * raising.apply(0, sums) + axes[axis][1] * raising.apply(1, sums) +
           axes[axis][2] * raising.apply(2, sums);
  };
  const auto base = [&](int factor) { return columns(moments.base, factor); };
  const auto raised = [&](int factor, int axis) {
    return raise(raise_, axis, columns(moments.raised, factor));
  };
  const auto times_p = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd { return p.asDiagonal() * m; };

  // How the direction to a fixed hit changes: r moves by -d and, bending with the surface, by
  // n (d^T S d) / 2.
  const Eigen::MatrixXd along_normal = times_p(base(kVrn)) + raised(kVt, 2);
  const auto gradient = [&](int g, int vr, int axis) -> Eigen::MatrixXd {
    return base(g) - times_p(base(vr)) - raised(kVt, axis);
  };
  const Eigen::MatrixXd vtt = columns(moments.twice_raised, kVtt);
  const auto hessian = [&](int h, int gr, int vrr, int a, int b) -> Eigen::MatrixXd {
    Eigen::MatrixXd m = base(h) - times_p(base(gr));
    m -= raised(kG1t + a, b) + raised(kG1t + b, a);
    m += times_p((p.array() - 2.0).matrix().asDiagonal() * base(vrr));
    if (a == b) m += times_p(vtt.topRows(count));
    m += times_p(raised(kVr1t + a, b) + raised(kVr1t + b, a));
    m += raise(raise_, a, raise(raise_again_, b, vtt));
    return m + s(a, b) * along_normal;
  };
  const Eigen::MatrixXd entries[IncidentHarmonics::kEntries] = {base(kV),
                                                                gradient(kG1, kVr1, 0),
                                                                gradient(kG2, kVr2, 1),
                                                                hessian(kH11, kGr11, kVrr11, 0, 0),
                                                                hessian(kH12, kGr12, kVrr12, 0, 1),
                                                                hessian(kH22, kGr22, kVrr22, 1, 1)};
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
