// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/lobes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/frame.h"
#include "scalar_lobes.h"
#include "statistics.h"

namespace vrc {
namespace {

const std::vector<Lobe>& all_lobes() {
  static const std::vector<Lobe> lobes = [] {
    std::vector<Lobe> list = {LambertLobe{}};
    for (const float exponent : {1.0f, 5.0f, 100.0f, 1000.0f})
      list.push_back(PhongLobe{Rgb::Ones(), exponent});
    for (const float alpha : {1.0f, 0.5f, 0.14f, 0.06f, 0.03f}) list.push_back(GgxLobe{Rgb::Ones(), alpha});
    return list;
  }();
  return lobes;
}

std::string name(const Lobe& lobe) {
  if (const auto* phong = std::get_if<PhongLobe>(&lobe)) return fmt::format("Phong {}", phong->exponent);
  if (const auto* ggx = std::get_if<GgxLobe>(&lobe)) return fmt::format("GGX {}", ggx->alpha);
  return "Lambert";
}

template <typename Function>
auto with(const Lobe& lobe, const Function& f) {
  return std::visit(f, lobe);
}

/// Pairs of directions at random normals: half of the incident ones close to the mirror direction.
struct RandomPairs {
  Random random{7};

  Directions16 next() {
    V3x16 n, wo, wi;
    for (int i = 0; i < kLanes; ++i) {
      const Vec3 normal = random.direction();
      const Vec3 out = i % 4 == 3 ? random.direction() : upper(normal);
      Vec3 in = random.direction();
      if (i % 2 == 0)
        in = (scalar::mirror(normal, out) + std::exp(random.uniform(-5.0, 0.0)) * in).normalized();
      set_lane(n, i, normal);
      set_lane(wo, i, out);
      set_lane(wi, i, in);
    }
    return directions(n, wo, wi);
  }
  Vec3 upper(const Vec3& normal) {
    const Vec3 w = random.direction();
    return w.dot(normal) < 0.0 ? Vec3(-w) : w;
  }
};

/// The lanes' vectors in double precision, of unit length again.
struct Pair {
  Vec3 n, wo, wi;
  Pair(const Directions16& d, int i)
      : n(lane(d.n, i).normalized()), wo(lane(d.wo, i).normalized()), wi(lane(d.wi, i).normalized()) {}
  /// Single precision cannot tell on which side of the horizon these are.
  bool at_horizon() const { return std::abs(n.dot(wo)) < 1e-3 || std::abs(n.dot(wi)) < 1e-3; }
};

/// Single-precision directions are exact to 1e-7; the sharpness of the lobe multiplies that.
double tolerance(const Lobe& lobe) {
  if (const auto* phong = std::get_if<PhongLobe>(&lobe)) return 2e-5 + 2e-6 * phong->exponent;
  if (const auto* ggx = std::get_if<GgxLobe>(&lobe)) return 2e-5 + 5e-6 / ggx->alpha;
  return 2e-5;
}

TEST(Lobes, ShapeAgreesWithTheTextbook) {
  for (const Lobe& lobe : all_lobes()) {
    RandomPairs pairs;
    int positive = 0;
    for (int packet = 0; packet < 500; ++packet) {
      const Directions16 d = pairs.next();
      const F16 value = with(lobe, [&](const auto& l) { return shape(l, d); });
      for (int i = 0; i < kLanes; ++i) {
        const Pair p(d, i);
        if (p.at_horizon()) continue;
        const double expected = with(lobe, [&](const auto& l) { return scalar::shape(l, p.n, p.wo, p.wi); });
        ASSERT_NEAR(value[i], expected, tolerance(lobe) * expected + 1e-6)
            << name(lobe) << " wo.n " << p.wo.dot(p.n) << " wi.n " << p.wi.dot(p.n);
        positive += expected > 1e-3;
      }
    }
    EXPECT_GT(positive, 800) << name(lobe);
  }
}

TEST(Lobes, PdfAgreesWithTheTextbook) {
  for (const Lobe& lobe : all_lobes()) {
    RandomPairs pairs;
    for (int packet = 0; packet < 500; ++packet) {
      const Directions16 d = pairs.next();
      const F16 value = with(lobe, [&](const auto& l) { return pdf(l, d); });
      for (int i = 0; i < kLanes; ++i) {
        const Pair p(d, i);
        // The renderer asks only for densities above the outgoing horizon.
        if (p.at_horizon() || p.n.dot(p.wo) < 0.0 || std::abs((p.wo + p.wi).normalized().dot(p.n)) < 1e-3)
          continue;
        const double expected = with(lobe, [&](const auto& l) { return scalar::pdf(l, p.n, p.wo, p.wi); });
        ASSERT_NEAR(value[i], expected, tolerance(lobe) * expected + 1e-6) << name(lobe);
      }
    }
  }
}

TEST(Lobes, DirectionsTellWhatTheyWereSampledFrom) {
  Random random{11};
  for (const Lobe& lobe : all_lobes()) {
    RandomPairs pairs;
    for (int packet = 0; packet < 500; ++packet) {
      const Directions16 d = pairs.next();
      F16 u1, u2;
      for (int i = 0; i < kLanes; ++i) {
        u1[i] = static_cast<float>(random.uniform(0.0, 1.0));
        u2[i] = static_cast<float>(random.uniform(0.0, 1.0));
      }
      const V3x16 wi = with(lobe, [&](const auto& l) { return sample(l, d.n, d.wo, u1, u2); });
      const SampleInverse inverse = inverse_of_sample(lobe, d.n, d.wo);
      const SampledFrom16 found = std::visit([&](const auto& of) { return of(wi); }, inverse);
      const auto* power = std::get_if<CosinePowerInverse>(&inverse);
      const F16 density = with(lobe, [&](const auto& l) { return pdf(l, directions(d.n, d.wo, wi)); });
      for (int i = 0; i < kLanes; ++i) {
        // Seen at grazing angles the disk of visible normals is a half; in the middle there is no azimuth.
        if (Pair(d, i).n.dot(Pair(d, i).wo) < 0.2 || u1[i] < 0.01f || u1[i] > 0.99f) continue;
        const double off = static_cast<double>(found.u2[i]) - static_cast<double>(u2[i]);
        ASSERT_NEAR(found.u1[i], u1[i], 2e-3) << name(lobe);
        ASSERT_LT(std::abs(off - std::round(off)), 2e-3) << name(lobe);
        ASSERT_NEAR(found.pdf[i], density[i], tolerance(lobe) * density[i] + 1e-6) << name(lobe);
        if (power != nullptr) {
          ASSERT_NEAR(power->cosine_at(found.pdf[i]), dot(wi, power->axis())[i], 1e-4) << name(lobe);
        }
      }
    }
  }
}

TEST(Lobes, BrdfIsReciprocal) {
  for (const Lobe& lobe : all_lobes()) {
    RandomPairs pairs;
    for (int packet = 0; packet < 200; ++packet) {
      const Directions16 d = pairs.next(), swapped = directions(d.n, d.wi, d.wo);
      const F16 forth = with(lobe, [&](const auto& l) { return shape(l, d); });
      const F16 back = with(lobe, [&](const auto& l) { return shape(l, swapped); });
      for (int i = 0; i < kLanes; ++i) {
        if (Pair(d, i).at_horizon()) continue;
        const double a = forth[i] / d.cos_i[i], b = back[i] / d.cos_o[i];
        ASSERT_NEAR(a, b, 1e-5 * std::abs(a)) << name(lobe);
      }
    }
  }
}

TEST(Lobes, NothingIsReflectedBelowTheHorizon) {
  const Vec3 n = Vec3(1, 2, -0.5).normalized();
  const Frame frame = Frame::around(n);
  const Vec3 above = (n + 2.0 * frame.tangent).normalized(),
             below = (2.0 * frame.bitangent - 0.1 * n).normalized();
  for (const Lobe& lobe : all_lobes()) {
    for (const auto& [wo, wi] : {std::pair(above, below), std::pair(below, above), std::pair(below, below)}) {
      const Directions16 d = directions(splat3(n), splat3(wo), splat3(wi));
      EXPECT_EQ(with(lobe, [&](const auto& l) { return shape(l, d); })[3], 0.0f) << name(lobe);
    }
  }
}

const double kOutgoingCosines[] = {1.0, 0.9, 0.6, 0.3, 0.1, 0.02};

Vec3 outgoing(double cosine) { return Vec3(std::sqrt(1.0 - cosine * cosine), 0.0, cosine); }

/// A grid that resolves the lobe about its mirror direction.
SphereGrid grid_for(const Lobe& lobe, const Vec3& n, const Vec3& wo) {
  if (std::holds_alternative<LambertLobe>(lobe)) return SphereGrid(n, 1, 64);
  return SphereGrid(scalar::mirror(n, wo), 4, 64, 64);
}

double directional_albedo(const Lobe& lobe, double cosine) {
  const Vec3 n = Vec3::UnitZ(), wo = outgoing(cosine);
  return grid_for(lobe, n, wo).integral([&](const V3x16& wi) {
    return with(lobe, [&](const auto& l) { return shape(l, directions(splat3(n), splat3(wo), wi)); });
  });
}

TEST(Lobes, NoneReflectsMoreThanItReceives) {
  for (const Lobe& lobe : all_lobes()) {
    for (const double cosine : kOutgoingCosines) {
      const double albedo = directional_albedo(lobe, cosine);
      EXPECT_LT(albedo, 1.0005) << name(lobe) << " at cosine " << cosine;
      EXPECT_GT(albedo, 0.0) << name(lobe);
    }
  }
}

TEST(Lobes, LambertAndPhongReflectEverythingAtNormalIncidence) {
  for (const Lobe& lobe : all_lobes()) {
    if (std::holds_alternative<GgxLobe>(lobe)) continue;
    EXPECT_NEAR(directional_albedo(lobe, 1.0), 1.0, 5e-4) << name(lobe);
  }
}

TEST(Lobes, SmoothGgxLosesLittleInTheWhiteFurnace) {
  for (const double cosine : {1.0, 0.9, 0.6}) {
    EXPECT_GT(directional_albedo(GgxLobe{Rgb::Ones(), 0.03f}, cosine), 0.995) << cosine;
    EXPECT_GT(directional_albedo(GgxLobe{Rgb::Ones(), 0.14f}, cosine), 0.95) << cosine;
  }
}

TEST(Lobes, SampledAlbedoAgreesWithQuadrature) {
  for (const Lobe& lobe : all_lobes()) {
    for (const double cosine : kOutgoingCosines) {
      const V3x16 n = splat3(Vec3(Vec3::UnitZ())), wo = splat3(outgoing(cosine));
      Random random(5);
      Estimate albedo;
      for (int packet = 0; packet < 1000; ++packet) {
        const F16 u1 = random.uniform16(), u2 = random.uniform16();
        const Directions16 d =
            directions(n, wo, with(lobe, [&](const auto& l) { return sample(l, n, wo, u1, u2); }));
        const F16 f = with(lobe, [&](const auto& l) { return shape(l, d); });
        const F16 density = with(lobe, [&](const auto& l) { return pdf(l, d); });
        for (int i = 0; i < kLanes; ++i) albedo.add(f[i] > 0.0f ? f[i] / density[i] : 0.0);
      }
      const double expected = directional_albedo(lobe, cosine);
      EXPECT_NEAR(albedo.mean(), expected, 4.5 * albedo.error() + 1e-3)
          << name(lobe) << " at cosine " << cosine;
    }
  }
}

TEST(Lobes, PdfIntegratesToOne) {
  for (const Lobe& lobe : all_lobes()) {
    for (const double cosine : kOutgoingCosines) {
      const Vec3 n = Vec3::UnitZ(), wo = outgoing(cosine);
      const double total = grid_for(lobe, n, wo).integral([&](const V3x16& wi) {
        return with(lobe, [&](const auto& l) { return pdf(l, directions(splat3(n), splat3(wo), wi)); });
      });
      EXPECT_NEAR(total, 1.0, 2e-3) << name(lobe) << " at cosine " << cosine;
    }
  }
}

TEST(Fresnel, NormalIncidenceIsTheClosedForm) {
  GgxLobe gold;
  gold.has_fresnel = true;
  gold.reflectance = Rgb(1.0f, 0.5f, 1.0f);
  gold.eta = Rgb(0.143f, 0.375f, 1.442f);
  gold.k = Rgb(3.983f, 2.386f, 1.603f);
  const V3x16 n = splat3(Vec3(Vec3::UnitZ()));
  const V3x16 color = tint(gold, directions(n, n, n));
  const Rgb expected = gold.reflectance * ((gold.eta - 1.0f).square() + gold.k.square()) /
                       ((gold.eta + 1.0f).square() + gold.k.square());
  EXPECT_NEAR(color.x[0], expected[0], 1e-5f);
  EXPECT_NEAR(color.y[7], expected[1], 1e-5f);
  EXPECT_NEAR(color.z[15], expected[2], 1e-5f);
}

TEST(Fresnel, AgreesWithTheComplexEquationsAtEveryAngle) {
  GgxLobe metal;
  metal.has_fresnel = true;
  metal.eta = Rgb(0.2f, 1.1f, 2.76f);
  metal.k = Rgb(3.9f, 0.0f, 3.84f);
  const V3x16 n = splat3(Vec3(Vec3::UnitZ()));
  for (double cosine = 0.01; cosine < 1.0; cosine += 0.01) {
    const Vec3 w = outgoing(cosine);
    // The half vector of mirrored directions is the normal.
    const V3x16 color = tint(metal, directions(n, splat3(w), splat3(scalar::mirror(Vec3::UnitZ(), w))));
    const Vec3 actual = lane(color, 0);
    for (int c = 0; c < 3; ++c) {
      const double expected = scalar::conductor_fresnel(cosine, metal.eta[c], metal.k[c]);
      EXPECT_NEAR(actual[c], expected, 2e-4) << "cosine " << cosine << " channel " << c;
      EXPECT_LE(actual[c], 1.00001);
    }
  }
}

TEST(Fresnel, MaterialNoneReflectsItsColour) {
  const GgxLobe lobe{Rgb(0.3f, 0.6f, 0.9f), 0.2f};
  const V3x16 n = splat3(Vec3(Vec3::UnitZ())), w = splat3(outgoing(0.4));
  EXPECT_EQ(lane(tint(lobe, directions(n, w, w)), 5).cast<float>(), Vec3f(0.3f, 0.6f, 0.9f));
}

TEST(Tangents, AreRightHandedForEveryNormal) {
  Random random(3);
  for (int packet = 0; packet < 200; ++packet) {
    V3x16 n;
    for (int i = 0; i < kLanes; ++i) set_lane(n, i, random.direction());
    set_lane(n, 0, -Vec3::UnitZ());
    set_lane(n, 1, Vec3(1.0, 0.0, -0.0));
    set_lane(n, 2, Vec3(1e-4, -1e-4, -1.0).normalized());
    const Tangents16 t = tangents(n);
    for (int i = 0; i < kLanes; ++i) {
      ASSERT_LT((lane(t.s, i).cross(lane(t.t, i)) - lane(n, i)).norm(), 2e-6) << lane(n, i).transpose();
      ASSERT_NEAR(lane(t.s, i).norm(), 1.0, 1e-6);
    }
  }
}

TEST(Strength, IsTheLuminanceOfTheReflectance) {
  EXPECT_NEAR(strength(LambertLobe{Rgb(0.0f, 1.0f, 0.0f)}), 0.71516f, 1e-5f);
  EXPECT_NEAR(strength(GgxLobe{Rgb::Constant(0.5f), 0.1f}), 0.5f, 1e-5f);
}

}  // namespace
}  // namespace vrc
