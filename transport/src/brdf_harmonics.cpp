// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/brdf_harmonics.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/sobol.h"
#include "sh/projection.h"
#include "sh/quadrature.h"
#include "transport/material.h"

namespace vrc {
namespace {

constexpr int kAngles = 65;        // outgoing polar angles of a table
constexpr int kLog2Samples = 11;   // of each
constexpr double kGrazing = 1e-3;  // cosine of the last: lobes are 0 below the surface

double cosine_of_entry(int i) { return std::max(std::cos(0.5 * kPi * i / (kAngles - 1)), kGrazing); }

bool is_colored(const Lobe& lobe) {
  const auto* ggx = std::get_if<GgxLobe>(&lobe);
  return ggx != nullptr && ggx->has_fresnel;
}

/// Rows of a frame, so that its product with a world vector has the frame's coordinates.
Mat3 rows_of(const Frame& frame) {
  Mat3 m;
  m.row(0) = frame.tangent;
  m.row(1) = frame.bitangent;
  m.row(2) = frame.normal;
  return m;
}

/// Coefficients of f cos_i in `frame` for one outgoing direction, the normal being z.
Eigen::MatrixXf project_lobe(const Lobe& lobe, const Vec3& outgoing, const Frame& frame,
                             const sh::Basis& basis, int channels) {
  constexpr std::size_t kPackets = (std::size_t{1} << kLog2Samples) / kLanes;
  const V3x16 n = splat3(Vec3(Vec3::UnitZ())), wo = splat3(outgoing);
  const Mat3 to_frame = rows_of(frame);
  const V3x16 rows[3] = {splat3(Vec3(to_frame.row(0))), splat3(Vec3(to_frame.row(1))),
                         splat3(Vec3(to_frame.row(2)))};
  std::vector<V3x16> directions_in_frame(kPackets);
  std::vector<F16> weights(kPackets), values(kPackets * static_cast<std::size_t>(channels));
  SobolGrid grid;
  fill_sobol_grid(grid, kLog2Samples, 1);
  for (std::size_t i = 0; i < kPackets; ++i) {
    F16 u1, u2;
    __builtin_memcpy(&u1, grid.u[0].data() + i * kLanes, sizeof(F16));
    __builtin_memcpy(&u2, grid.u[1].data() + i * kLanes, sizeof(F16));
    std::visit(
        [&](const auto& l) {
          const V3x16 wi = sample(l, n, wo, u1, u2);
          const Directions16 d = directions(n, wo, wi);
          const F16 density = pdf(l, d);
          const I16 counts = (d.cos_i > 0.0f) & (density > 1e-20f);
          directions_in_frame[i] = {dot(rows[0], wi), dot(rows[1], wi), dot(rows[2], wi)};
          weights[i] = select(counts, 1.0f / (density * static_cast<float>(1 << kLog2Samples)), F16{});
          const F16 f_cos = select(counts, shape(l, d), F16{});
          if (channels == 1) {
            values[i] = f_cos;
          } else {
            const V3x16 color = tint(l, d) * f_cos;
            values[i] = color.x;
            values[kPackets + i] = color.y;
            values[2 * kPackets + i] = color.z;
          }
        },
        lobe);
  }
  return sh::project_samples(basis, {directions_in_frame, weights, values}).cast<float>();
}

}  // namespace

LobeHarmonics::LobeHarmonics(const Lobe& lobe, const sh::Basis& basis)
    : lobe_(lobe), channels_(is_colored(lobe) ? 3 : 1) {
  std::visit([](auto& l) { l.reflectance = Rgb::Ones(); }, lobe_);
  // Lambert's does not depend on the angle.
  const int angles = std::holds_alternative<LambertLobe>(lobe) ? 1 : kAngles;
  for (int i = 0; i < angles; ++i) {
    const double cosine = cosine_of_entry(i);
    const Vec3 outgoing(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
    table_.push_back(project_lobe(lobe_, outgoing, frame(Vec3::UnitZ(), outgoing), basis, channels_));
  }
}

void LobeHarmonics::response(double cos_o, Eigen::MatrixXf& result) const {
  if (table_.size() == 1) {
    result = table_.front();
    return;
  }
  const double place = std::acos(std::clamp(cos_o, 0.0, 1.0)) * (2.0 / kPi) * (kAngles - 1);
  const int i = std::min(static_cast<int>(place), kAngles - 2);
  const auto t = static_cast<float>(place - i);
  const auto k = static_cast<std::size_t>(i);
  result = (1.0f - t) * table_[k] + t * table_[k + 1];
}

Frame LobeHarmonics::frame(const Vec3& normal, const Vec3& outgoing) const {
  const double cosine = normal.dot(outgoing);
  const Vec3 sideways = outgoing - cosine * normal;
  const double sine = sideways.norm();
  if (sine < 1e-6) return Frame::around(normal);
  const Vec3 t = sideways / sine;
  if (std::holds_alternative<LambertLobe>(lobe_)) return {t, normal.cross(t), normal};
  // The outgoing direction is (sine, 0, cosine) in (t, b, n); its mirror image (-sine, 0, cosine).
  return {cosine * t + sine * normal, normal.cross(t), cosine * normal - sine * t};
}

void BrdfHarmonics::response(const Vec3& normal, const Vec3& outgoing,
                             Eigen::Ref<Eigen::MatrixXf> weights) const {
  weights.setZero();
  const double cos_o = normal.dot(outgoing);
  if (cos_o <= 0.0) return;
  static thread_local Eigen::MatrixXf local, world;  // storage only
  for (const Part& part : parts_) {
    part.lobe->response(cos_o, local);
    world.resize(local.rows(), local.cols());
    rotator_->rotate(part.lobe->frame(normal, outgoing), local, world);
    for (int c = 0; c < 3; ++c) weights.col(c) += part.reflectance[c] * world.col(world.cols() == 3 ? c : 0);
  }
}

const Eigen::MatrixXf& BrdfHarmonics::matrix(int channel) const {
  std::call_once(matrices_made_, [this] { make_matrices(); });
  return matrices_[channel];
}

/// M_jk = integral of Y_j(w_o) w_k(w_o) over the upper hemisphere. At azimuth p the weights of (l, m),
/// m >= 0, and (l, -m) are those at azimuth 0 times cos(m p) and sin(m p); the azimuth integrates in
/// closed form.
void BrdfHarmonics::make_matrices() const {
  const int order = rotator_->order();
  const int n = sh::coefficient_count(order);
  for (Eigen::MatrixXf& m : matrices_) m.setZero(n, n);
  const sh::Basis basis(order);
  const sh::Quadrature rule = sh::gauss_legendre(2 * (order + 1), 0.0, 1.0);
  Eigen::MatrixXf weights(n, 3);
  std::vector<double> y(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double cosine = rule.nodes[i];
    const Vec3 outgoing(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
    response(Vec3::UnitZ(), outgoing, weights);
    basis.evaluate(outgoing, y);
    for (int m = 0; m <= order; ++m) {
      const double azimuth = rule.weights[i] * (m == 0 ? 2.0 * kPi : kPi);
      for (int l = m; l <= order; ++l) {
        for (int k = m; k <= order; ++k) {
          const auto factor = static_cast<float>(azimuth * y[static_cast<std::size_t>(sh::index(l, m))]);
          for (int c = 0; c < 3; ++c) {
            const float entry = factor * weights(sh::index(k, m), c);
            matrices_[c](sh::index(l, m), sh::index(k, m)) += entry;
            if (m > 0) matrices_[c](sh::index(l, -m), sh::index(k, -m)) += entry;
          }
        }
      }
    }
  }
}

BrdfHarmonicsSet::BrdfHarmonicsSet(const std::vector<Bsdf>& bsdfs, std::span<const int> orders)
    : bsdfs_(bsdfs), entries_(bsdfs.size()) {
  VRC_CHECK(orders.size() == bsdfs.size(), "{} orders of {} BRDFs", orders.size(), bsdfs.size());
  for (const int order : orders) tools_of_.push_back(&tools_.try_emplace(order, order).first->second);
}

const BrdfHarmonics& BrdfHarmonicsSet::of(std::size_t material) const {
  Entry& entry = entries_[material];
  std::call_once(entry.made, [&] { entry.brdf = make(bsdfs_[material], *tools_of_[material]); });
  return *entry.brdf;
}

std::unique_ptr<const BrdfHarmonics> BrdfHarmonicsSet::make(const Bsdf& bsdf, const Tools& tools) {
  const std::lock_guard lock(tools.making);
  std::vector<BrdfHarmonics::Part> parts;
  for (const Lobe& lobe : bsdf.lobes) {
    auto found =
        std::ranges::find_if(tools.lobes, [&](const auto& l) { return same_shape(l->lobe(), lobe); });
    if (found == tools.lobes.end())
      found = tools.lobes.insert(found, std::make_shared<const LobeHarmonics>(lobe, tools.basis));
    parts.push_back({std::visit([](const auto& l) { return l.reflectance; }, lobe), *found});
  }
  return std::make_unique<const BrdfHarmonics>(std::move(parts), tools.rotator);
}

}  // namespace vrc
