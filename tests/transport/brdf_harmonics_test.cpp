// SPDX-License-Identifier: GPL-3.0-or-later
// BRDFs in spherical harmonics against textbook lobes and plain quadrature.
#include "transport/brdf_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scalar_lobes.h"
#include "sh/projection.h"
#include "sh/rotation.h"
#include "statistics.h"

namespace vrc {
namespace {

struct NamedMaterial {
  const char* name;
  Material material;
};

const std::vector<NamedMaterial>& materials() {
  static const std::vector<NamedMaterial> list = [] {
    GgxLobe copper{Rgb(0.9f, 0.8f, 0.7f), 0.35f, true, Rgb(0.2f, 0.92f, 1.1f), Rgb(3.9f, 2.45f, 2.14f)};
    const Material lambert{"lambert", {LambertLobe{Rgb(0.5f, 0.3f, 0.1f)}}, true};
    const Material phong{"phong", {PhongLobe{Rgb(0.4f, 0.4f, 0.6f), 20.0f}}, true};
    const Material ggx{"ggx", {GgxLobe{Rgb::Ones(), 0.3f}}, true};
    return std::vector<NamedMaterial>{{"Lambert", lambert},
                                      {"Phong 20", phong},
                                      {"GGX 0.3", ggx},
                                      {"blend", blend(lambert, phong, 0.4f)},
                                      {"copper", {"copper", {copper}, true}}};
  }();
  return list;
}

std::vector<Bsdf> bsdfs() {
  std::vector<Bsdf> list;
  for (const NamedMaterial& m : materials()) list.emplace_back(m.material);
  return list;
}

/// f cos_i of one channel.
double f_cos(const Material& material, const Vec3& n, const Vec3& wo, const Vec3& wi, int channel) {
  double sum = 0.0;
  for (const Lobe& lobe : material.lobes) {
    std::visit(
        [&](const auto& l) {
          double color = l.reflectance[channel];
          if constexpr (std::is_same_v<std::decay_t<decltype(l)>, GgxLobe>) {
            if (l.has_fresnel) {
              color *=
                  scalar::conductor_fresnel(wo.dot((wo + wi).normalized()), l.eta[channel], l.k[channel]);
            }
          }
          sum += color * scalar::shape(l, n, wo, wi);
        },
        lobe);
  }
  return sum;
}

double relative(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected) {
  return (actual - expected).norm() / expected.norm();
}

Vec3 at_angle(const Frame& frame, double polar, double azimuth) {
  return std::sin(polar) * (std::cos(azimuth) * frame.tangent + std::sin(azimuth) * frame.bitangent) +
         std::cos(polar) * frame.normal;
}

TEST(BrdfHarmonics, RespondLikeTheProjectedBrdf) {
  constexpr int kOrder = 10;
  const std::vector<Bsdf> list = bsdfs();
  const BrdfHarmonicsSet set(list, kOrder);
  const Frame frame = Frame::around(Vec3(0.3, -0.5, 0.8).normalized());
  Eigen::MatrixXf weights(sh::coefficient_count(kOrder), 3);
  for (std::size_t m = 0; m < list.size(); ++m) {
    const Material& material = materials()[m].material;
    for (const double polar : {0.0, 0.4, 0.83, 1.2}) {
      const Vec3 wo = at_angle(frame, polar, 2.1);
      set.of(m).response(frame.normal, wo, weights);
      for (int c = 0; c < 3; ++c) {
        const Eigen::VectorXd expected = sh::project(
            kOrder, [&](const Vec3& wi) { return f_cos(material, frame.normal, wo, wi, c); }, 200);
        EXPECT_LT(relative(weights.col(c).cast<double>(), expected), 0.01)
            << materials()[m].name << ", polar angle " << polar << ", channel " << c;
      }
    }
  }
}

TEST(BrdfHarmonics, DoNotRespondBelowTheSurface) {
  const std::vector<Bsdf> list = bsdfs();
  const BrdfHarmonicsSet set(list, 4);
  Eigen::MatrixXf weights = Eigen::MatrixXf::Ones(sh::coefficient_count(4), 3);
  set.of(1).response(Vec3::UnitZ(), Vec3(0.8, 0.0, -0.6), weights);
  EXPECT_EQ(weights.norm(), 0.0f);
}

TEST(BrdfHarmonics, TurnWithTheSurface) {
  constexpr int kOrder = 8;
  const std::vector<Bsdf> list = bsdfs();
  const BrdfHarmonicsSet set(list, kOrder);
  const int count = sh::coefficient_count(kOrder);
  const Vec3 wo = Vec3(0.5, 0.3, 0.7).normalized();
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const sh::Rotation rotation(kOrder, turn);
  Eigen::MatrixXf before(count, 3), after(count, 3);
  for (std::size_t m = 0; m < list.size(); ++m) {
    set.of(m).response(Vec3::UnitZ(), wo, before);
    set.of(m).response(turn * Vec3::UnitZ(), turn * wo, after);
    EXPECT_LT(relative(after.cast<double>(), rotation.apply(before.cast<double>())), 1e-5)
        << materials()[m].name;
  }
}

/// Integral of Y_j(w_o) f cos_i Y_k(w_i) over both hemispheres.
Eigen::MatrixXd brute_force_matrix(const Material& material, int channel, int order) {
  constexpr int kPolar = 36, kAzimuth = 72;
  const sh::Quadrature rule = sh::gauss_legendre(kPolar, 0.0, 1.0);
  const sh::Basis basis(order);
  std::vector<Vec3> directions;
  Eigen::MatrixXd y(kPolar * kAzimuth, basis.size());  // times the root of the solid angle's square
  std::vector<double> values(static_cast<std::size_t>(basis.size()));
  for (int i = 0; i < kPolar; ++i) {
    for (int k = 0; k < kAzimuth; ++k) {
      const auto p = static_cast<std::size_t>(i);
      const double azimuth = 2.0 * kPi * (k + 0.5) / kAzimuth;
      directions.push_back(at_angle(Frame{}, std::acos(rule.nodes[p]), azimuth));
      basis.evaluate(directions.back(), values);
      const double solid_angle = rule.weights[p] * 2.0 * kPi / kAzimuth;
      y.row(i * kAzimuth + k) =
          solid_angle * Eigen::Map<const Eigen::RowVectorXd>(values.data(), basis.size());
    }
  }
  Eigen::MatrixXd f(directions.size(), directions.size());
  for (std::size_t o = 0; o < directions.size(); ++o) {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      f(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i)) =
          f_cos(material, Vec3::UnitZ(), directions[o], directions[i], channel);
    }
  }
  return y.transpose() * f * y;
}

TEST(BrdfHarmonics, HaveTheMatrixOfTheDoubleIntegral) {
  constexpr int kOrder = 5;
  const std::vector<Bsdf> list = bsdfs();
  const BrdfHarmonicsSet set(list, kOrder);
  for (std::size_t m = 0; m < list.size(); ++m) {
    for (const int c : {0, 2}) {
      const Eigen::MatrixXd expected = brute_force_matrix(materials()[m].material, c, kOrder);
      EXPECT_LT(relative(set.of(m).matrix(c).cast<double>(), expected), 0.01)
          << materials()[m].name << ", channel " << c;
    }
  }
}

TEST(BrdfHarmonics, MatrixAgreesWithTheResponseInOpenDirections) {
  constexpr int kOrder = 20;
  const std::vector<Bsdf> list = bsdfs();
  const BrdfHarmonicsSet set(list, kOrder);
  const int count = sh::coefficient_count(kOrder);
  Eigen::VectorXf incident = Eigen::VectorXf::Zero(count);
  incident.head<9>() << 2.0f, 0.3f, 0.9f, -0.4f, 0.1f, 0.2f, -0.3f, 0.15f, 0.1f;
  std::vector<double> y(static_cast<std::size_t>(count));
  Eigen::MatrixXf weights(count, 3);
  for (std::size_t m = 0; m < list.size(); ++m) {
    double error = 0.0, size = 0.0;
    const Eigen::VectorXd outgoing = (set.of(m).matrix(0) * incident).cast<double>();
    // Outgoing radiance ends at the horizon, where its harmonics ring.
    for (double polar = 0.0; polar < 1.1; polar += 0.1) {
      const Vec3 wo = at_angle(Frame{}, polar, 3.0 * polar);
      sh::evaluate(kOrder, wo, y);
      set.of(m).response(Vec3::UnitZ(), wo, weights);
      const double exact = static_cast<double>(weights.col(0).dot(incident));
      error += std::pow(Eigen::Map<const Eigen::VectorXd>(y.data(), count).dot(outgoing) - exact, 2);
      size += exact * exact;
    }
    EXPECT_LT(std::sqrt(error / size), 0.05) << materials()[m].name;
  }
}

TEST(BrdfHarmonicsSet, SharesEqualLobes) {
  const Material a{"a", {LambertLobe{Rgb::Constant(0.2f)}, PhongLobe{Rgb::Constant(0.5f), 20.0f}}, true};
  const Material b{"b", {PhongLobe{Rgb::Constant(0.1f), 20.0f}}, true};
  const Material c{"c", {PhongLobe{Rgb::Constant(0.1f), 21.0f}}, true};
  const std::vector<Bsdf> list = {Bsdf(a), Bsdf(b), Bsdf(c)};
  const BrdfHarmonicsSet set(list, 4);
  ASSERT_EQ(set.of(0).parts().size(), 2u);
  EXPECT_EQ(set.of(0).parts()[1].lobe, set.of(1).parts()[0].lobe);
  EXPECT_NE(set.of(1).parts()[0].lobe, set.of(2).parts()[0].lobe);
  EXPECT_EQ(&set.of(0), &set.of(0));
}

}  // namespace
}  // namespace vrc
