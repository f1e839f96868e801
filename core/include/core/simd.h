// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include "core/lanes.h"
#include "core/types.h"

namespace vrc {

// Sixteen lanes, the width of an Embree packet.
inline constexpr int kLanes = 16;
#if defined(__AVX512F__)
using F16 = float __attribute__((vector_size(64)));
using I16 = std::int32_t __attribute__((vector_size(64)));  ///< Integers, or a mask of 0 and -1.
using U16 = std::uint32_t __attribute__((vector_size(64)));
#else
using F16 = Lanes16<float>;
using I16 = Lanes16<std::int32_t>;  ///< Integers, or a mask of 0 and -1.
using U16 = Lanes16<std::uint32_t>;
#endif

[[nodiscard]] inline F16 splat(float value) { return value - F16{}; }  // - 0 costs nothing
[[nodiscard]] inline I16 splat(std::int32_t value) { return I16{} + value; }
[[nodiscard]] inline U16 splat(std::uint32_t value) { return U16{} + value; }
[[nodiscard]] inline I16 lane_index() {
  return std::bit_cast<I16>(std::array{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15});
}

#if defined(__AVX512F__)
[[nodiscard]] inline F16 select(I16 mask, F16 yes, F16 no) { return mask ? yes : no; }
[[nodiscard]] inline I16 select(I16 mask, I16 yes, I16 no) { return mask ? yes : no; }
[[nodiscard]] inline F16 to_float(I16 v) { return __builtin_convertvector(v, F16); }
[[nodiscard]] inline F16 to_float(U16 v) { return __builtin_convertvector(v, F16); }
[[nodiscard]] inline I16 to_int(F16 v) { return __builtin_convertvector(v, I16); }
#else
[[nodiscard]] inline F16 select(I16 mask, F16 yes, F16 no) { return chosen(mask, yes, no); }
[[nodiscard]] inline I16 select(I16 mask, I16 yes, I16 no) { return chosen(mask, yes, no); }
[[nodiscard]] inline F16 to_float(I16 v) { return converted<float>(v); }
[[nodiscard]] inline F16 to_float(U16 v) { return converted<float>(v); }
[[nodiscard]] inline I16 to_int(F16 v) { return converted<std::int32_t>(v); }
#endif
/// Sixteen short integers from memory.
[[nodiscard]] inline F16 load_shorts(const std::int16_t* from) {
#if defined(__AVX512F__)
  std::int16_t __attribute__((vector_size(2 * kLanes))) shorts;
  __builtin_memcpy(&shorts, from, sizeof(shorts));
  return __builtin_convertvector(shorts, F16);
#else
  F16 result;
  for (int i = 0; i < kLanes; ++i) result[i] = from[i];
  return result;
#endif
}
[[nodiscard]] inline I16 bits(F16 v) { return std::bit_cast<I16>(v); }
[[nodiscard]] inline F16 from_bits(I16 v) { return std::bit_cast<F16>(v); }

// NaN in `a` yields `b`, as the hardware instructions do.
[[nodiscard]] inline F16 min(F16 a, F16 b) { return select(a < b, a, b); }
[[nodiscard]] inline F16 max(F16 a, F16 b) { return select(a > b, a, b); }
[[nodiscard]] inline F16 max(F16 a, float b) { return max(a, splat(b)); }
[[nodiscard]] inline F16 min(F16 a, float b) { return min(a, splat(b)); }
/// A 32-bit fraction as a float in [0, 1).
[[nodiscard]] inline F16 to_unit_interval(U16 fraction) { return to_float(fraction >> 8) * 0x1p-24f; }
/// The nearest coordinate of a sample in [0, 1).
[[nodiscard]] inline F16 within_unit(F16 u) { return min(max(u, 0.0f), 0x1.fffffep-1f); }
[[nodiscard]] inline F16 abs(F16 v) { return from_bits(bits(v) & 0x7fffffff); }

// The zero-masking intrinsics have no undefined operand for GCC 12 to warn about.
[[nodiscard]] inline F16 sqrt(F16 v) {
#if defined(__AVX512F__)
  return std::bit_cast<F16>(_mm512_maskz_sqrt_ps(0xffff, std::bit_cast<__m512>(v)));
#elif defined(__AVX2__)
  return v.map([](F16::Part p) { return _mm256_sqrt_ps(p); });
#else
  F16 result;
  for (int i = 0; i < kLanes; ++i) result[i] = std::sqrt(v[i]);
  return result;
#endif
}

[[nodiscard]] inline F16 floor(F16 v) {
#if defined(__AVX512F__)
  return std::bit_cast<F16>(
      _mm512_maskz_roundscale_ps(0xffff, std::bit_cast<__m512>(v), _MM_FROUND_TO_NEG_INF));
#elif defined(__AVX2__)
  return v.map([](F16::Part p) { return _mm256_floor_ps(p); });
#else
  F16 result;
  for (int i = 0; i < kLanes; ++i) result[i] = std::floor(v[i]);
  return result;
#endif
}

/// Bit i is set where lane i of the mask is.
[[nodiscard]] inline std::uint32_t mask_bits(I16 mask) {
#if defined(__AVX512F__)
  return _mm512_cmplt_epi32_mask(std::bit_cast<__m512i>(mask), _mm512_setzero_si512());
#elif defined(__AVX2__)
  const auto bits_of = [](I16::Part p) {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(p)));
  };
  return bits_of(mask.part[0]) | bits_of(mask.part[1]) << I16::kPartLanes;
#else
  std::uint32_t result = 0;
  for (int i = 0; i < kLanes; ++i) result |= static_cast<std::uint32_t>(mask[i] < 0) << i;
  return result;
#endif
}
[[nodiscard]] inline bool any(I16 mask) { return mask_bits(mask) != 0; }
[[nodiscard]] inline bool all(I16 mask) { return mask_bits(mask) == 0xffffu; }
/// The lowest lane that is set; the mask must not be empty.
[[nodiscard]] inline int first_lane(I16 mask) { return std::countr_zero(mask_bits(mask)); }

/// base[index[i]] for every lane; all indices must be readable.
[[nodiscard]] inline F16 gather(const float* base, I16 index) {
#if defined(__AVX512F__)
  return std::bit_cast<F16>(
      _mm512_mask_i32gather_ps(_mm512_setzero_ps(), 0xffff, std::bit_cast<__m512i>(index), base, 4));
#elif defined(__AVX2__)
  F16 result;
  for (int i = 0; i < F16::kParts; ++i)
    result.part[i] = _mm256_i32gather_ps(base, reinterpret_cast<__m256i>(index.part[i]), 4);
  return result;
#else
  F16 result;
  for (int i = 0; i < kLanes; ++i) result[i] = base[index[i]];
  return result;
#endif
}

[[nodiscard]] inline I16 gather(const std::int32_t* base, I16 index) {
#if defined(__AVX512F__)
  return std::bit_cast<I16>(
      _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), 0xffff, std::bit_cast<__m512i>(index), base, 4));
#elif defined(__AVX2__)
  I16 result;
  for (int i = 0; i < I16::kParts; ++i)
    result.part[i] = reinterpret_cast<I16::Part>(
        _mm256_i32gather_epi32(base, reinterpret_cast<__m256i>(index.part[i]), 4));
  return result;
#else
  I16 result;
  for (int i = 0; i < kLanes; ++i) result[i] = base[index[i]];
  return result;
#endif
}

[[nodiscard]] inline float lane_sum(F16 v) {
  float sum = 0.0f;
  for (int i = 0; i < kLanes; ++i) sum += v[i];
  return sum;
}
[[nodiscard]] inline float lane_min(F16 v) {
  float result = v[0];
  for (int i = 1; i < kLanes; ++i) result = v[i] < result ? v[i] : result;
  return result;
}
[[nodiscard]] inline float lane_max(F16 v) {
  float result = v[0];
  for (int i = 1; i < kLanes; ++i) result = v[i] > result ? v[i] : result;
  return result;
}

/// Base-2 logarithm of a positive normal number; absolute error below 1e-7 near 1, relative 2e-7.
[[nodiscard]] F16 log2(F16 v);
/// 2^v, relative error below 2e-7; v below -126 yields 0.
[[nodiscard]] F16 exp2(F16 v);
/// v^p for v >= 0 (0^p = 0).
[[nodiscard]] inline F16 pow(F16 v, float p) {
  return select(v > 1e-37f, exp2(log2(max(v, 1e-37f)) * p), F16{});
}

struct SinCos16 {
  F16 sin, cos;
};
/// Sine and cosine of 2 pi u, u in [0, 1].
[[nodiscard]] SinCos16 sincos_2pi(F16 u);
/// The turns in [0, 1) by which a vector lies counterclockwise of the x axis; absolute error below 1.5e-7.
/// 0 for the null vector.
[[nodiscard]] F16 turns(F16 x, F16 y);

/// Three components, sixteen lanes each.
struct V3x16 {
  F16 x, y, z;

  V3x16 operator+(const V3x16& o) const { return {x + o.x, y + o.y, z + o.z}; }
  V3x16 operator-(const V3x16& o) const { return {x - o.x, y - o.y, z - o.z}; }
  V3x16 operator-() const { return {-x, -y, -z}; }
  V3x16 operator*(F16 s) const { return {x * s, y * s, z * s}; }
  V3x16 operator*(float s) const { return {x * s, y * s, z * s}; }
  V3x16 operator*(const V3x16& o) const { return {x * o.x, y * o.y, z * o.z}; }
  V3x16& operator+=(const V3x16& o) { return *this = *this + o; }
};

template <typename Vector3>
[[nodiscard]] inline V3x16 splat3(const Vector3& v) {
  return {splat(static_cast<float>(v[0])), splat(static_cast<float>(v[1])), splat(static_cast<float>(v[2]))};
}
[[nodiscard]] inline F16 dot(const V3x16& a, const V3x16& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline V3x16 cross(const V3x16& a, const V3x16& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline V3x16 normalize(const V3x16& v) { return v * (1.0f / sqrt(dot(v, v))); }
[[nodiscard]] inline V3x16 select(I16 mask, const V3x16& yes, const V3x16& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
[[nodiscard]] inline F16 luminance(const V3x16& c) {
  return static_cast<float>(kLuminance[0]) * c.x + static_cast<float>(kLuminance[1]) * c.y +
         static_cast<float>(kLuminance[2]) * c.z;
}

}  // namespace vrc
