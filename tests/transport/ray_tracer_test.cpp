// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/ray_tracer.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "geometry/shapes.h"
#include "geometry/surface_mesh.h"
#include "statistics.h"

namespace vrc {
namespace {

using Coherence = RayTracer::Coherence;

struct Soup {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;

  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3& p : {a, b, c}) {
      indices.push_back(static_cast<std::uint32_t>(positions.size() / 3));
      for (int i = 0; i < 3; ++i) positions.push_back(static_cast<float>(p[i]));
    }
  }
  std::size_t size() const { return indices.size() / 3; }
  Vec3 corner(std::size_t triangle, int k) const {
    const float* p = positions.data() + 3 * indices[3 * triangle + k];
    return Vec3(p[0], p[1], p[2]);
  }
  RayTracer tracer() const { return RayTracer(positions, indices); }
};

Soup random_soup(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  Soup soup;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 center = 2.0 * random.uniform() * random.direction();
    const auto corner = [&]() -> Vec3 { return center + 0.8 * random.uniform() * random.direction(); };
    soup.add(corner(), corner(), corner());
  }
  return soup;
}

struct ExactHit {
  double t = std::numeric_limits<double>::infinity(), u = 0.0, v = 0.0;
  std::size_t triangle = 0;
  bool doubtful = false;  ///< Some triangle is met so close to its edge or so flatly that rounding decides.

  bool found() const { return std::isfinite(t); }
};

/// Moeller-Trumbore in double precision over every triangle.
ExactHit brute_force(const Soup& soup, const Vec3& origin, const Vec3& direction, double t_max) {
  ExactHit best;
  for (std::size_t i = 0; i < soup.size(); ++i) {
    const Vec3 e1 = soup.corner(i, 1) - soup.corner(i, 0), e2 = soup.corner(i, 2) - soup.corner(i, 0);
    const Vec3 p = direction.cross(e2), s = origin - soup.corner(i, 0), q = s.cross(e1);
    const double det = e1.dot(p), u = s.dot(p) / det, v = direction.dot(q) / det, t = e2.dot(q) / det;
    const double margin = std::min({u, v, 1.0 - u - v});
    const bool flat = std::abs(e1.cross(e2).normalized().dot(direction.normalized())) < 1e-3;
    const bool near_end = std::abs(t) < 1e-4 || std::abs(t - t_max) < 1e-4;
    if (margin > -1e-4 && t > -1e-4 && t < t_max + 1e-4 && (margin < 1e-4 || flat || near_end))
      best.doubtful = true;
    if (margin < 0.0 || t < 0.0 || t > t_max || t >= best.t) continue;
    best.t = t;
    best.u = u;
    best.v = v;
    best.triangle = i;
  }
  return best;
}

class AgainstBruteForce : public ::testing::TestWithParam<Coherence> {};

TEST_P(AgainstBruteForce, FindsTheSameHits) {
  const Soup soup = random_soup(200, 1);
  const RayTracer tracer = soup.tracer();
  Random random(2);
  int hits = 0, misses = 0;
  for (int packet = 0; packet < 400; ++packet) {
    V3x16 origin, direction;
    F16 t_max;
    for (int i = 0; i < kLanes; ++i) {
      set_lane(origin, i, 3.0 * random.uniform() * random.direction());
      set_lane(direction, i, random.uniform(0.2, 3.0) * random.direction());  // of any length
      t_max[i] = i % 3 == 0 ? static_cast<float>(random.uniform(0.1, 3.0)) : 1e17f;
    }
    const I16 active = (lane_index() % 5) != 4;
    const Ray16 ray = {origin, direction, t_max};
    const Hit16 hit = tracer.intersect(active, ray, GetParam());
    const I16 occluded = tracer.occluded(active, ray, GetParam());
    for (int i = 0; i < kLanes; ++i) {
      if (active[i] == 0) {
        ASSERT_EQ(hit.hit[i], 0);
        ASSERT_EQ(occluded[i], 0);
        continue;
      }
      const ExactHit exact = brute_force(soup, lane(origin, i), lane(direction, i), t_max[i]);
      if (exact.doubtful) continue;
      ASSERT_EQ(hit.hit[i] != 0, exact.found());
      ASSERT_EQ(occluded[i], hit.hit[i]);
      ++(exact.found() ? hits : misses);
      if (!exact.found()) continue;
      ASSERT_EQ(hit.triangle[i], static_cast<std::int32_t>(exact.triangle));
      ASSERT_NEAR(hit.t[i], exact.t, 1e-4 * (1.0 + exact.t));
      ASSERT_NEAR(hit.u[i], exact.u, 1e-3);
      ASSERT_NEAR(hit.v[i], exact.v, 1e-3);
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(misses, 1000);
}

INSTANTIATE_TEST_SUITE_P(Packets, AgainstBruteForce,
                         ::testing::Values(Coherence::kIncoherent, Coherence::kCoherent));

TEST(RayTracer, RaysThatAreNotFiniteMiss) {
  Soup soup;
  soup.add({-9, -9, 1}, {9, -9, 1}, {0, 9, 1});
  const RayTracer tracer = soup.tracer();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  Ray16 ray = {splat3(Vec3(0, 0, 0)), splat3(Vec3(0, 0, 1)), splat(1e17f)};
  ray.origin.x[0] = kNan;
  ray.origin.z[1] = kInfinity;
  ray.origin.y[2] = 1e30f;
  ray.direction.x[3] = kNan;
  ray.direction.z[4] = kInfinity;
  ray.direction.y[5] = -1e30f;
  ray.t_max[6] = kNan;
  ray.t_max[7] = -1.0f;
  ray.t_max[8] = 0.0f;
  ray.direction.z[9] = 0.0f;  // no direction at all
  for (const auto coherence : {Coherence::kIncoherent, Coherence::kCoherent}) {
    const Hit16 hit = tracer.intersect(splat(-1), ray, coherence);
    EXPECT_EQ(mask_bits(hit.hit), 0xfc00u);
    EXPECT_EQ(mask_bits(tracer.occluded(splat(-1), ray, coherence)), 0xfc00u);
    for (int i = 0; i < kLanes; ++i) EXPECT_EQ(hit.triangle[i], 0) << "readable where nothing was hit";
  }
}

TEST(RayTracer, FarRaysAndInfiniteReachAreHandled) {
  Soup soup;
  soup.add({-1e6, -1e6, 1}, {1e6, -1e6, 1}, {0, 1e6, 1});
  const RayTracer tracer = soup.tracer();
  Ray16 ray = {splat3(Vec3(0, 0, -1e6)), splat3(Vec3(0, 0, 1e-3)),
               splat(std::numeric_limits<float>::infinity())};
  ray.origin.z[3] = -9e17f;
  ray.direction.z[3] = 9e17f;
  const Hit16 hit = tracer.intersect(splat(-1), ray, Coherence::kIncoherent);
  EXPECT_TRUE(all(hit.hit));
  EXPECT_NEAR(hit.t[0], 1e9f, 1e5f);
  EXPECT_NEAR(hit.t[3], 1.0f, 1e-3f);
}

/// A sphere, seen from points inside it.
class ClosedMesh : public ::testing::Test {
 protected:
  static constexpr int kRays = 100000;

  ClosedMesh() {
    const SurfaceMesh mesh = build_surface_mesh(make_sphere(kCenter, 1.7, 12));
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto [a, b, c] = mesh.positions(f);
      soup_.add(a, b, c);
    }
  }

  /// Rays towards target(random) that leave the closed mesh, of both queries together.
  template <typename Target>
  int leaks(const Target& target) const {
    const RayTracer tracer = soup_.tracer();
    Random random(5);
    int missed = 0;
    for (int packet = 0; packet < kRays / kLanes; ++packet) {
      V3x16 origin, direction;
      for (int i = 0; i < kLanes; ++i) {
        set_lane(origin, i, kCenter + 1.5 * random.uniform() * random.direction());
        set_lane(direction, i, target(random) - lane(origin, i));
      }
      const Ray16 ray = {origin, direction, splat(1e17f)};
      missed +=
          kLanes - std::popcount(mask_bits(tracer.intersect(splat(-1), ray, Coherence::kIncoherent).hit));
      missed += kLanes - std::popcount(mask_bits(tracer.occluded(splat(-1), ray, Coherence::kIncoherent)));
    }
    return missed;
  }
  Vec3 on_edge(Random& random, double along) const {
    const auto face = static_cast<std::size_t>(random.uniform() * static_cast<double>(soup_.size()));
    const int k = static_cast<int>(3.0 * random.uniform());
    return (1.0 - along) * soup_.corner(face, k) + along * soup_.corner(face, (k + 1) % 3);
  }

  const Vec3 kCenter = Vec3(0.1, -0.2, 0.3);
  Soup soup_;
};

TEST_F(ClosedMesh, DoesNotLeakAtEdges) {
  EXPECT_EQ(leaks([&](Random& random) { return on_edge(random, random.uniform(0.01, 0.99)); }), 0);
}

TEST_F(ClosedMesh, DoesNotLeakAnywhereElse) {
  EXPECT_EQ(leaks([&](Random& random) -> Vec3 { return kCenter + 1.7 * random.direction(); }), 0);
}

TEST_F(ClosedMesh, HardlyLeaksAtVertices) {
  // Embree's robust mode has cracks of the width of a rounding error at vertices (its issues 174 and
  // 181): no ray finds them unless it is aimed there.
  EXPECT_LT(leaks([&](Random& random) { return on_edge(random, 0.0); }), 2 * kRays / 1000);
}

TEST(RayTracer, MovesItsScene) {
  Soup soup;
  soup.add({-9, -9, 1}, {9, -9, 1}, {0, 9, 1});
  RayTracer first = soup.tracer();
  RayTracer second = std::move(first);
  const Ray16 ray = {splat3(Vec3(0, 0, 0)), splat3(Vec3(0, 0, 1)), splat(2.0f)};
  EXPECT_TRUE(all(second.occluded(splat(-1), ray, Coherence::kCoherent)));
}

}  // namespace
}  // namespace vrc
