// SPDX-License-Identifier: GPL-3.0-or-later
// Analytic jets against finite differences of the slow lobes along the moving point.
#include "transport/lobe_jets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "core/frame.h"
#include "scalar_lobes.h"
#include "statistics.h"

namespace vrc {
namespace {

/// A record in its own frame (x at the origin, normal +z) with the fixed points that it sees.
struct Config {
  Vec3 hit;  ///< y
  Vec3 camera;
  Mat2 s = Mat2::Zero();
  Vec3 reflector_normal, light;  ///< At y.
};

/// The record's point and normal after the tangent displacement d and a tilt t beyond the shape operator's,
/// by definition.
struct Moved {
  Vec3 x, n;
  Moved(const Mat2& s, const Vec2& d, const Vec2& t = Vec2::Zero()) {
    const Vec2 bend = s * d, turn = bend + t;
    x = Vec3(d.x(), d.y(), -0.5 * d.dot(bend));
    n = Vec3(turn.x(), turn.y(), 1.0).normalized();
  }
};

using Scalar = std::function<double(const Vec2&)>;
using Derivatives = std::array<double, 5>;  // g1 g2 h11 h12 h22

Derivatives central_differences(const Scalar& f, double h) {
  const auto at = [&](int i, int j) { return f(Vec2(i * h, j * h)); };
  return {(at(1, 0) - at(-1, 0)) / (2 * h), (at(0, 1) - at(0, -1)) / (2 * h),
          (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / (h * h),
          (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h),
          (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / (h * h)};
}

/// Derivatives of f / f(0) by two steps of Richardson extrapolation.
Derivatives finite_differences(const Scalar& f, double h) {
  const Derivatives a = central_differences(f, h), b = central_differences(f, h / 2),
                    c = central_differences(f, h / 4);
  const double value = f(Vec2::Zero());
  Derivatives result{};
  for (std::size_t i = 0; i < 5; ++i) {
    const double ab = (4 * b[i] - a[i]) / 3, bc = (4 * c[i] - b[i]) / 3;
    result[i] = (16 * bc - ab) / 15 / value;
  }
  return result;
}

/// Mixed derivatives d^2 f / dd_i dt_j over f(0, 0), row by row, by Richardson extrapolation.
using ScalarOfTwo = std::function<double(const Vec2& d, const Vec2& t)>;
std::array<double, 4> mixed_differences(const ScalarOfTwo& f, double hd, double ht) {
  const double value = f(Vec2::Zero(), Vec2::Zero());
  std::array<double, 4> result{};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const auto differences = [&](double a, double b) {
        const Vec2 d = a * Vec2::Unit(i), t = b * Vec2::Unit(j);
        return (f(d, t) - f(d, -t) - f(-d, t) + f(-d, -t)) / (4.0 * a * b * value);
      };
      const double x = differences(hd, ht), y = differences(hd / 2, ht / 2), z = differences(hd / 4, ht / 4);
      result[static_cast<std::size_t>(2 * i + j)] = (16 * (4 * z - y) / 3 - (4 * y - x) / 3) / 15;
    }
  }
  return result;
}

TiltingJet16 along(const Mat2& s, const TiltingJet16& j) {
  const Eigen::Matrix2f f = s.cast<float>();
  return along_surface(j, f(0, 0), f(0, 1), f(1, 1));
}

Derivatives lane_of(const UnitJet16& j, int i) { return {j.g1[i], j.g2[i], j.h11[i], j.h12[i], j.h22[i]}; }

/// Natural scales are those of the lobe: a gradient below sqrt(Hessian) moves nothing.
void expect_jet(const Derivatives& actual, const Derivatives& expected, double length,
                const std::string& what) {
  const double h = std::hypot(expected[2], std::sqrt(2.0) * expected[3], expected[4]);
  const double g = std::max({std::hypot(expected[0], expected[1]), std::sqrt(h), 1.0 / length});
  const double h_scale = std::max(h, 1.0 / (length * length));
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_NEAR(actual[i], expected[i], 1e-3 * (i < 2 ? g : h_scale)) << what << ", component " << i;
  }
}

RecordFrame record_frame(const Config& c, const Frame& world) {
  const auto to_world = [&](const Vec3& v) -> Vec3f {
    return (world.tangent * v.x() + world.bitangent * v.y() + world.normal * v.z()).cast<float>();
  };
  RecordFrame frame;
  frame.x = Vec3f::Zero();
  frame.tangent = world.tangent.cast<float>();
  frame.bitangent = world.bitangent.cast<float>();
  frame.normal = world.normal.cast<float>();
  frame.to_camera = to_world(c.camera);
  frame.shape_operator = c.s.cast<float>();
  return frame;
}

MovingPoint16 moving(const Config& c) {
  const Frame world = Frame::around(Vec3(-0.3, 0.5, -0.8).normalized());
  const Vec3 r = world.tangent * c.hit.x() + world.bitangent * c.hit.y() + world.normal * c.hit.z();
  return moving_point(record_frame(c, world), splat3(r));
}

/// Random configurations; every second one has no curvature.
class Configs {
 public:
  explicit Configs(std::uint64_t seed) : random_(seed) {}

  Vec3 upper(double lowest) {
    for (;;) {
      const Vec3 w = random_.direction();
      if (w.z() > lowest) return w;
    }
  }

  /// `spread`: how far the hit may be from the mirror direction; large for anywhere.
  Config next(double spread) {
    Config c;
    const Vec3 to_camera = upper(0.15);
    const double length = std::exp(random_.uniform(-1.5, 1.5));
    const Vec3 mirrored(-to_camera.x(), -to_camera.y(), to_camera.z());
    Vec3 r;
    do {
      r = (mirrored + spread * random_.uniform() * random_.direction()).normalized();
    } while (r.z() < 0.1);
    c.hit = length * r;
    c.camera = std::exp(random_.uniform(0.0, 2.0)) * length * to_camera;
    if (count_++ % 2 == 1) {
      const double size = random_.uniform(0.0, 2.0) / length, a = random_.uniform(-1, 1),
                   b = random_.uniform(-1, 1);
      const double turn = random_.uniform(0.0, kPi), cs = std::cos(turn), sn = std::sin(turn);
      Mat2 axes;
      axes << cs, -sn, sn, cs;
      c.s = size * axes * Vec2(a, b).asDiagonal() * axes.transpose();
    }
    // A reflector that sends light towards the record, mirrored up to the spread.
    c.reflector_normal = (-r + 0.8 * random_.direction()).normalized();
    if (c.reflector_normal.dot(-r) < 0.3) c.reflector_normal = -r;
    do {
      const Vec3 mirror_light = scalar::mirror(c.reflector_normal, -r);
      c.light = (mirror_light + spread * random_.uniform() * random_.direction()).normalized();
    } while (c.light.dot(c.reflector_normal) < 0.1);
    return c;
  }

 private:
  Random random_;
  int count_ = 0;
};

struct JetCase {
  Lobe lobe;
  double width;   ///< Of the lobe, in radians: the length scale of its derivatives.
  double spread;  ///< Configurations stay where the lobe is not negligible.
};

std::string print(const JetCase& c) {
  if (const auto* phong = std::get_if<PhongLobe>(&c.lobe))
    return fmt::format("Phong_{:.0f}", phong->exponent);
  if (const auto* ggx = std::get_if<GgxLobe>(&c.lobe)) return fmt::format("GGX_{:.0f}", 100 * ggx->alpha);
  return "Lambert";
}

class LobeJets : public ::testing::TestWithParam<JetCase> {
 protected:
  static constexpr int kConfigs = 400;
  double step(const Config& c) const { return 0.05 * GetParam().width * c.hit.norm(); }
};

/// f (n . r) of the lobe at the displaced record.
double moved_shape(const auto& lobe, const Vec3& n, const Vec3& r, const Vec3& v) {
  return scalar::shape(lobe, n, v.normalized(), r.normalized()) * r.norm();
}
/// Where GGX keeps its shadowing only D, cos_o and the length of r change.
double moved_without_masking(const auto& lobe, const Vec3& n, const Vec3& r, const Vec3& v) {
  return moved_shape(lobe, n, r, v);
}
double moved_without_masking(const GgxLobe& lobe, const Vec3& n, const Vec3& r, const Vec3& v) {
  const Vec3 wi = r.normalized(), wo = v.normalized(), h = (wi + wo).normalized();
  return scalar::ggx_distribution(lobe.alpha, n.dot(h)) / (4.0 * n.dot(wo) * n.dot(wi)) * n.dot(r);
}

TEST_P(LobeJets, ShapeMatchesFiniteDifferences) {
  Configs configs(21);
  for (int i = 0; i < kConfigs; ++i) {
    const Config c = configs.next(GetParam().spread);
    MovingPoint16 p = moving(c);
    std::visit(
        [&](const auto& lobe) {
          const auto check = [&](const auto& shape) {
            const Scalar f = [&](const Vec2& d) {
              const Moved m(c.s, d);
              return shape(lobe, m.n, c.hit - m.x, c.camera - m.x);
            };
            const Derivatives total = lane_of(along(c.s, shape_jet<TiltingJet16>(lobe, p)).moved, i % kLanes);
            expect_jet(total, finite_differences(f, step(c)), c.hit.norm(),
                       fmt::format("configuration {}", i));
            // Without tilts, for surfaces that do not bend.
            if (c.s.isZero())
              expect_jet(lane_of(shape_jet<UnitJet16>(lobe, p), i % kLanes), total, c.hit.norm(), "flat");
          };
          check([](const auto&... all) { return moved_shape(all...); });
          p.masking_moves = false;
          check([](const auto&... all) { return moved_without_masking(all...); });
        },
        GetParam().lobe);
  }
}

TEST_P(LobeJets, TiltsMatchFiniteDifferences) {
  Configs configs(25);
  for (int i = 0; i < kConfigs; ++i) {
    const Config c = configs.next(GetParam().spread);
    const MovingPoint16 p = moving(c);
    const double tilt_step = 0.05 * GetParam().width;
    std::visit(
        [&](const auto& lobe) {
          const ScalarOfTwo f = [&](const Vec2& d, const Vec2& t) {
            const Moved m(c.s, d, t);
            return moved_shape(lobe, m.n, c.hit - m.x, c.camera - m.x);
          };
          const TiltingJet16 j = along(c.s, shape_jet<TiltingJet16>(lobe, p));
          const int lane = i % kLanes;
          const Derivatives by_tilt = {j.n1[lane], j.n2[lane], j.m11[lane], j.m12[lane], j.m22[lane]};
          expect_jet(by_tilt,
                     finite_differences([&](const Vec2& t) { return f(Vec2::Zero(), t); }, tilt_step), 1.0,
                     fmt::format("tilts of configuration {}", i));
          const std::array<double, 4> mixed = {j.x11[lane], j.x12[lane], j.x21[lane], j.x22[lane]};
          const auto expected = mixed_differences(f, step(c), tilt_step);
          // The scale of products of a derivative by d and one by t.
          const Derivatives by_place = lane_of(j.moved, lane);
          const auto size = [](const Derivatives& v) {
            return std::max(std::hypot(v[0], v[1]), std::sqrt(std::hypot(v[2], std::sqrt(2.0) * v[3], v[4])));
          };
          const double scale = std::max(size(by_place), 1.0 / c.hit.norm()) * std::max(size(by_tilt), 1.0);
          for (std::size_t k = 0; k < 4; ++k)
            ASSERT_NEAR(mixed[k], expected[k], 1e-3 * scale) << "configuration " << i << ", entry " << k;
        },
        GetParam().lobe);
  }
}

double reflected(const LambertLobe&, const Vec3&, const Vec3&, const Vec3&) { return 1.0 / kPi; }
double reflected(const PhongLobe& lobe, const Vec3& n, const Vec3& light, const Vec3& out) {
  return std::pow(scalar::mirror(n, light).dot(out), static_cast<double>(lobe.exponent));
}
double reflected(const GgxLobe& lobe, const Vec3& n, const Vec3& light, const Vec3& out) {
  return scalar::shape(lobe, n, out, light);
}
double reflected_without_masking(const auto& lobe, const Vec3& n, const Vec3& light, const Vec3& out) {
  return reflected(lobe, n, light, out);
}
double reflected_without_masking(const GgxLobe& lobe, const Vec3& n, const Vec3& light, const Vec3& out) {
  return scalar::ggx_distribution(lobe.alpha, n.dot((light + out).normalized())) / n.dot(out);
}

TEST_P(LobeJets, ReflectorMatchesFiniteDifferences) {
  Configs configs(22);
  for (int i = 0; i < kConfigs; ++i) {
    const Config c = configs.next(GetParam().spread);
    MovingPoint16 p = moving(c);
    const FixedReflector16 y = {splat3(c.reflector_normal), splat3(c.light),
                                splat(static_cast<float>(c.reflector_normal.dot(c.hit))),
                                splat(static_cast<float>(c.reflector_normal.dot(c.light))),
                                splat(static_cast<float>(c.light.dot(c.hit)))};
    std::visit(
        [&](const auto& lobe) {
          const auto check = [&](const auto& reflect) {
            const Scalar f = [&](const Vec2& d) {
              return reflect(lobe, c.reflector_normal, c.light, (Moved(c.s, d).x - c.hit).normalized());
            };
            expect_jet(lane_of(reflector_jet(lobe, y, p), i % kLanes), finite_differences(f, step(c)),
                       c.hit.norm(), fmt::format("configuration {}", i));
          };
          check([](const auto&... all) { return reflected(all...); });
          p.masking_moves = false;
          check([](const auto&... all) { return reflected_without_masking(all...); });
        },
        GetParam().lobe);
  }
}

INSTANTIATE_TEST_SUITE_P(Lobes, LobeJets,
                         ::testing::Values(JetCase{LambertLobe{}, 1.0, 3.0},
                                           JetCase{PhongLobe{Rgb::Ones(), 5.0f}, 0.5, 0.7},
                                           JetCase{PhongLobe{Rgb::Ones(), 100.0f}, 0.1, 0.4},
                                           JetCase{PhongLobe{Rgb::Ones(), 1000.0f}, 0.03, 0.15},
                                           JetCase{GgxLobe{Rgb::Ones(), 0.5f}, 0.5, 1.5},
                                           JetCase{GgxLobe{Rgb::Ones(), 0.14f}, 0.14, 0.7},
                                           JetCase{GgxLobe{Rgb::Ones(), 0.06f}, 0.06, 0.3}),
                         [](const auto& test) { return print(test.param); });

TEST(MovingPoint, ValuesAreTheProductsOfTheVectors) {
  Configs configs(23);
  for (int i = 0; i < 50; ++i) {
    const Config c = configs.next(2.0);
    const MovingPoint16 p = moving(c);
    const double scale = 1e-5 * (1.0 + c.camera.squaredNorm() + c.hit.squaredNorm());
    EXPECT_NEAR(p.r1[3], c.hit.x(), scale);
    EXPECT_NEAR(p.r2[3], c.hit.y(), scale);
    EXPECT_NEAR(p.nr[3], c.hit.z(), scale);
    EXPECT_NEAR(p.v1[3], c.camera.x(), scale);
    EXPECT_NEAR(p.v2[3], c.camera.y(), scale);
    EXPECT_NEAR(p.nv[3], c.camera.z(), scale);
    EXPECT_NEAR(p.rr[3], c.hit.squaredNorm(), scale);
    EXPECT_NEAR(p.vv[3], c.camera.squaredNorm(), scale);
    EXPECT_NEAR(p.rv[3], c.hit.dot(c.camera), scale);
  }
}

TEST(MovingPoint, BasisJetsMatchFiniteDifferences) {
  Configs configs(24);
  for (int i = 0; i < 400; ++i) {
    const Config c = configs.next(2.0);
    const MovingPoint16 p = moving(c);
    const double length = c.hit.norm();
    const auto check = [&](const UnitJet16& jet, double jet_length, const std::string& what,
                           const std::function<double(const Moved&)>& f) {
      const Derivatives expected =
          finite_differences([&](const Vec2& d) { return f(Moved(c.s, d)); }, 0.05 * length);
      expect_jet(lane_of(jet, 7), expected, jet_length, fmt::format("{} of configuration {}", what, i));
    };
    const auto total = [&](const TiltingJet16& jet) { return along(c.s, jet).moved; };
    check(total(jet_of_nr<TiltingJet16>(p)), length, "n.r",
          [&](const Moved& m) { return m.n.dot(c.hit - m.x); });
    check(total(jet_of_nv<TiltingJet16>(p)), length, "n.v",
          [&](const Moved& m) { return m.n.dot(c.camera - m.x); });
    check(p.jet_rr, length, "r.r", [&](const Moved& m) { return (c.hit - m.x).squaredNorm(); });
    check(p.jet_vv, length, "v.v", [&](const Moved& m) { return (c.camera - m.x).squaredNorm(); });
    const Vec3 a = c.light;
    const double value = a.dot(c.hit);
    if (std::abs(value) < 0.1 * length) continue;
    const auto f = [](double v) { return splat(static_cast<float>(v)); };
    check(jet_of_linear(p, f(value), f(a.x()), f(a.y()), f(a.z())), length, "a.r",
          [&](const Moved& m) { return a.dot(c.hit - m.x); });
  }
}

TEST(LobeJetsAtTheirLimits, StayFinite) {
  // Hits on the tangent plane, behind the lobe, straight below the camera; reflectors seen edge-on.
  const Lobe lobes[] = {LambertLobe{}, PhongLobe{Rgb::Ones(), 1000.0f}, GgxLobe{Rgb::Ones(), 0.03f}};
  Config c;
  c.camera = Vec3(0.0, 0.3, 1.0);
  c.s << 1.0, 0.2, 0.2, -0.5;
  for (const Vec3& hit :
       {Vec3(1, 0, 0), Vec3(0, 1, 1e-9), Vec3(0, 0, 1e-6), Vec3(0, 0.3, 1), Vec3(0.5, -0.3, -1e-8)}) {
    c.hit = hit;
    const MovingPoint16 p = moving(c);
    const V3x16 n = splat3(Vec3(hit.unitOrthogonal())), light = splat3(Vec3(hit.normalized()));
    const FixedReflector16 y = {n, light, F16{}, F16{}, splat(static_cast<float>(hit.norm()))};
    for (const Lobe& lobe : lobes) {
      std::visit(
          [&](const auto& l) {
            const TiltingJet16 tilting = shape_jet<TiltingJet16>(l, p);
            const UnitJet16 by_tilt = {tilting.n1, tilting.n2, tilting.m11, tilting.m12, tilting.m22};
            const UnitJet16 mixed = {tilting.x11, tilting.x12, tilting.x21, tilting.x22, F16{}};
            for (const UnitJet16& jet : {tilting.moved, by_tilt, mixed, reflector_jet(l, y, p)}) {
              for (const double v : lane_of(jet, 0)) EXPECT_TRUE(std::isfinite(v)) << hit.transpose();
            }
          },
          lobe);
    }
  }
}

}  // namespace
}  // namespace vrc
