// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/hash.h"

namespace vrc {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Uniform numbers in [low, high), lane after lane.
class Uniform16 {
 public:
  F16 next(double low, double high) {
    F16 v;
    for (int i = 0; i < kLanes; ++i) {
      const double u = static_cast<double>(hash(99, counter_++) >> 11) * 0x1p-53;
      v[i] = static_cast<float>(low + u * (high - low));
    }
    return v;
  }

 private:
  std::uint64_t counter_ = 0;
};

/// Largest error of `fast` against `exact` over random arguments, divided by scale(exact value).
template <typename Fast, typename Exact, typename Scale>
double worst_error(double low, double high, const Fast& fast, const Exact& exact, const Scale& scale) {
  Uniform16 random;
  double worst = 0.0;
  for (int packet = 0; packet < 5000; ++packet) {
    const F16 v = random.next(low, high);
    const F16 result = fast(v);
    for (int i = 0; i < kLanes; ++i) {
      const double expected = exact(static_cast<double>(v[i]));
      worst = std::max(worst, std::abs(static_cast<double>(result[i]) - expected) / scale(expected));
    }
  }
  return worst;
}

const auto relative = [](double v) { return std::abs(v) + 1e-300; };
const auto absolute = [](double) { return 1.0; };

TEST(Simd, Log2AgreesWithLibm) {
  const auto fast = [](F16 v) { return log2(v); };
  const auto exact = [](double v) { return std::log2(v); };
  EXPECT_LT(worst_error(0.75, 1.4, fast, exact, absolute), 1e-7);
  EXPECT_LT(worst_error(1e-6, 0.5, fast, exact, relative), 2e-7);
  EXPECT_LT(worst_error(2.0, 1e30, fast, exact, relative), 2e-7);
  // Near 1 the logarithm keeps its relative accuracy: sharp Phong lobes depend on it.
  EXPECT_LT(worst_error(0.99, 1.01, fast, exact, relative), 4e-7);
  EXPECT_EQ(log2(splat(1.0f))[0], 0.0f);
  EXPECT_EQ(log2(splat(0x1p-126f))[3], -126.0f);
  EXPECT_EQ(log2(splat(0x1p127f))[15], 127.0f);
}

TEST(Simd, Exp2AgreesWithLibm) {
  const auto fast = [](F16 v) { return exp2(v); };
  const auto exact = [](double v) { return std::exp2(v); };
  EXPECT_LT(worst_error(-1.0, 1.0, fast, exact, relative), 2e-7);
  EXPECT_LT(worst_error(-126.0, 127.0, fast, exact, relative), 2e-7);
  for (int e = -126; e <= 127; ++e) {
    ASSERT_EQ(exp2(splat(static_cast<float>(e)))[0], std::ldexp(1.0f, e));
  }
  EXPECT_EQ(exp2(splat(-126.001f))[0], 0.0f);
  EXPECT_EQ(exp2(splat(-kInfinity))[0], 0.0f);
}

TEST(Simd, PowAgreesWithLibm) {
  for (const float p : {0.1f, 1.0f / 3.0f, 1.0f, 2.0f, 5.0f, 30.0f, 100.0f, 1000.0f}) {
    const auto fast = [p](F16 v) { return pow(v, p); };
    const auto exact = [p](double v) { return std::pow(v, static_cast<double>(p)); };
    // p log2(v) is rounded to single precision: values down to 2^-20 lose 20 ulps at most.
    const double low = std::exp2(-20.0 / static_cast<double>(p));
    EXPECT_LT(worst_error(std::max(low, 1e-3), 1.0, fast, exact, relative), 5e-6) << "p = " << p;
    EXPECT_LT(worst_error(0.0, 1.0, fast, exact, absolute), 3e-7) << "p = " << p;
    EXPECT_EQ(pow(F16{}, p)[5], 0.0f);
    EXPECT_EQ(pow(splat(1.0f), p)[5], 1.0f);
  }
}

TEST(Simd, SineAndCosineAgreeWithLibm) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const auto sine = [](F16 v) { return sincos_2pi(v).sin; };
  const auto cosine = [](F16 v) { return sincos_2pi(v).cos; };
  EXPECT_LT(worst_error(
                0.0, 1.0, sine, [](double v) { return std::sin(kTurn * v); }, absolute),
            2e-7);
  EXPECT_LT(worst_error(
                0.0, 1.0, cosine, [](double v) { return std::cos(kTurn * v); }, absolute),
            2e-7);
  const float expected_sin[] = {0, 1, 0, -1, 0}, expected_cos[] = {1, 0, -1, 0, 1};
  for (int quarter = 0; quarter <= 4; ++quarter) {
    const SinCos16 result = sincos_2pi(splat(0.25f * static_cast<float>(quarter)));
    EXPECT_EQ(result.sin[7], expected_sin[quarter]) << quarter;
    EXPECT_EQ(result.cos[7], expected_cos[quarter]) << quarter;
  }
}

TEST(Simd, TurnsAreThoseOfSineAndCosine) {
  Uniform16 random;
  for (int packet = 0; packet < 1000; ++packet) {
    const F16 u = random.next(0.0, 1.0), length = random.next(1e-3, 1e3);
    const SinCos16 direction = sincos_2pi(u);
    const F16 found = turns(length * direction.cos, length * direction.sin);
    for (int i = 0; i < kLanes; ++i) {
      const double off = static_cast<double>(found[i]) - static_cast<double>(u[i]);
      ASSERT_LT(std::abs(off - std::round(off)), 2e-7) << u[i];
      ASSERT_GE(found[i], 0.0f);
      ASSERT_LT(found[i], 1.0f);
    }
  }
  EXPECT_EQ(turns(F16{}, F16{})[3], 0.0f);
  EXPECT_EQ(turns(splat(1.0f), splat(-1e-30f))[3], 0.0f);
  EXPECT_EQ(turns(splat(-2.0f), F16{})[3], 0.5f);
}

TEST(Simd, SqrtAndFloorAreExact) {
  Uniform16 random;
  for (int packet = 0; packet < 1000; ++packet) {
    const F16 v = random.next(0.0, 1e6), w = random.next(-1000.0, 1000.0);
    const F16 root = sqrt(v), whole = floor(w);
    for (int i = 0; i < kLanes; ++i) {
      ASSERT_EQ(root[i], std::sqrt(v[i]));
      ASSERT_EQ(whole[i], std::floor(w[i]));
    }
  }
  for (const float v : {-1.0f, -0.5f, 0.0f, 0.5f, 2.0f, -2.0f, 1e9f, -1e9f}) {
    EXPECT_EQ(floor(splat(v))[0], std::floor(v));
  }
  EXPECT_TRUE(std::isnan(sqrt(splat(-1.0f))[0]));
}

TEST(Simd, MinAndMaxYieldTheSecondForNan) {
  const F16 nan = splat(kNan), one = splat(1.0f), two = splat(2.0f);
  EXPECT_EQ(min(one, two)[0], 1.0f);
  EXPECT_EQ(max(one, two)[0], 2.0f);
  EXPECT_EQ(min(two, one)[0], 1.0f);
  EXPECT_EQ(max(two, one)[0], 2.0f);
  EXPECT_EQ(min(nan, one)[0], 1.0f);
  EXPECT_EQ(max(nan, one)[0], 1.0f);
  EXPECT_TRUE(std::isnan(min(one, nan)[0]));
  EXPECT_TRUE(std::isnan(max(one, nan)[0]));
  EXPECT_EQ(max(nan, 0.0f)[9], 0.0f);
}

TEST(Simd, AbsClearsTheSign) {
  EXPECT_EQ(abs(splat(-3.5f))[0], 3.5f);
  EXPECT_EQ(abs(splat(3.5f))[0], 3.5f);
  EXPECT_FALSE(std::signbit(abs(splat(-0.0f))[0]));
  EXPECT_EQ(abs(splat(-kInfinity))[0], kInfinity);
}

TEST(Simd, GatherReadsEveryLane) {
  std::vector<float> table(100);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(3 * i);
  const I16 index = lane_index() * 6 + 2;
  const F16 read = gather(table.data(), index);
  std::vector<std::int32_t> numbers(100);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = -7 * static_cast<std::int32_t>(i);
  const I16 whole = gather(numbers.data(), index);
  const F16 negative = gather(table.data() + 50, -lane_index());
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_EQ(read[i], static_cast<float>(3 * (6 * i + 2)));
    EXPECT_EQ(negative[i], static_cast<float>(3 * (50 - i)));
    EXPECT_EQ(whole[i], -7 * (6 * i + 2));
  }
}

TEST(Simd, MasksSelectAndCount) {
  for (const std::uint32_t wanted : {0u, 1u, 0x8000u, 0xffffu, 0x5a5au}) {
    I16 mask{};
    for (int i = 0; i < kLanes; ++i) mask[i] = (wanted >> i) & 1u ? -1 : 0;
    EXPECT_EQ(mask_bits(mask), wanted);
    EXPECT_EQ(any(mask), wanted != 0);
    EXPECT_EQ(all(mask), wanted == 0xffffu);
    if (wanted != 0) {
      EXPECT_EQ(first_lane(mask), std::countr_zero(wanted));
    }
    const F16 chosen = select(mask, splat(1.0f), splat(2.0f));
    for (int i = 0; i < kLanes; ++i) EXPECT_EQ(chosen[i], (wanted >> i) & 1u ? 1.0f : 2.0f);
  }
  EXPECT_EQ(mask_bits(lane_index() < 3), 7u);
}

TEST(Simd, LaneReductions) {
  const F16 v = to_float((lane_index() * 7 + 3) % 16);  // a permutation of 0 .. 15
  EXPECT_EQ(lane_sum(v), 120.0f);
  EXPECT_EQ(lane_min(v), 0.0f);
  EXPECT_EQ(lane_max(v), 15.0f);
}

TEST(Simd, ConversionsTruncateAndKeepUnsignedValues) {
  EXPECT_EQ(to_int(splat(-2.7f))[0], -2);
  EXPECT_EQ(to_int(splat(2.7f))[0], 2);
  EXPECT_EQ(to_float(splat(-5))[0], -5.0f);
  EXPECT_EQ(to_float(splat(0xffffff00u))[0], 4294967040.0f);
  EXPECT_EQ(from_bits(bits(splat(1.25f)))[4], 1.25f);
}

TEST(Simd, VectorProducts) {
  Uniform16 random;
  const auto vector = [&] { return V3x16{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)}; };
  for (int packet = 0; packet < 100; ++packet) {
    const V3x16 a = vector(), b = vector();
    const V3x16 c = cross(a, b), unit = normalize(a);
    for (int i = 0; i < kLanes; ++i) {
      EXPECT_NEAR(dot(a, c)[i], 0.0f, 5e-7f);
      EXPECT_NEAR(dot(b, c)[i], 0.0f, 5e-7f);
      EXPECT_NEAR(dot(c, c)[i], dot(a, a)[i] * dot(b, b)[i] - dot(a, b)[i] * dot(a, b)[i], 5e-6f);
      EXPECT_NEAR(dot(unit, unit)[i], 1.0f, 5e-7f);
    }
  }
}

}  // namespace
}  // namespace vrc
