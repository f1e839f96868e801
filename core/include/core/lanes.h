// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstdint>

namespace vrc {

/// Sixteen numbers like a vector of the compiler's, made of vectors as wide as the machine's. (GCC takes
/// wider ones apart for sums and products, but compares and selects their lanes one by one.)
template <typename Element>
struct alignas(64) Lanes16 {
#if defined(__AVX2__)
  static constexpr int kPartBytes = 32;
#else
  static constexpr int kPartBytes = 16;
#endif
  static constexpr int kParts = 64 / kPartBytes;
  static constexpr int kPartLanes = 16 / kParts;
  typedef Element Part __attribute__((vector_size(kPartBytes)));  // NOLINT(modernize-use-using)
  using Mask = Lanes16<std::int32_t>;

  Part part[kParts];

  Lanes16() = default;
  Lanes16(Element value) {  // NOLINT(google-explicit-constructor): scalars mix with lanes
    for (Part& p : part) p = Part{} + value;
  }

  template <std::integral Index>
  Element& operator[](Index i) {
    return reinterpret_cast<Element*>(part)[i];
  }
  template <std::integral Index>
  Element operator[](Index i) const {
    return reinterpret_cast<const Element*>(part)[i];
  }

  Lanes16 operator-() const {
    return map([](Part a) { return -a; });
  }
  Lanes16 operator~() const {
    return map([](Part a) { return ~a; });
  }
  friend Lanes16 operator+(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x + y; });
  }
  friend Lanes16 operator-(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x - y; });
  }
  friend Lanes16 operator*(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x * y; });
  }
  friend Lanes16 operator/(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x / y; });
  }
  friend Lanes16 operator%(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x % y; });
  }
  friend Lanes16 operator&(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x & y; });
  }
  friend Lanes16 operator|(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x | y; });
  }
  friend Lanes16 operator^(const Lanes16& a, const Lanes16& b) {
    return map2(a, b, [](Part x, Part y) { return x ^ y; });
  }
  friend Lanes16 operator<<(const Lanes16& a, int n) {
    return a.map([n](Part x) { return x << n; });
  }
  friend Lanes16 operator>>(const Lanes16& a, int n) {
    return a.map([n](Part x) { return x >> n; });
  }
  friend Mask operator<(const Lanes16& a, const Lanes16& b) {
    return compare(a, b, [](Part x, Part y) { return x < y; });
  }
  friend Mask operator<=(const Lanes16& a, const Lanes16& b) {
    return compare(a, b, [](Part x, Part y) { return x <= y; });
  }
  friend Mask operator>(const Lanes16& a, const Lanes16& b) {
    return compare(a, b, [](Part x, Part y) { return x > y; });
  }
  friend Mask operator>=(const Lanes16& a, const Lanes16& b) {
    return compare(a, b, [](Part x, Part y) { return x >= y; });
  }
  friend Mask operator==(const Lanes16& a, const Lanes16& b) {
    return compare(a, b, [](Part x, Part y) { return x == y; });
  }
  friend Mask operator!=(const Lanes16& a, const Lanes16& b) {
    return compare(a, b, [](Part x, Part y) { return x != y; });
  }
  Lanes16& operator+=(const Lanes16& o) { return *this = *this + o; }
  Lanes16& operator-=(const Lanes16& o) { return *this = *this - o; }
  Lanes16& operator*=(const Lanes16& o) { return *this = *this * o; }
  Lanes16& operator/=(const Lanes16& o) { return *this = *this / o; }
  Lanes16& operator&=(const Lanes16& o) { return *this = *this & o; }
  Lanes16& operator|=(const Lanes16& o) { return *this = *this | o; }
  Lanes16& operator^=(const Lanes16& o) { return *this = *this ^ o; }

  template <typename Function>
  Lanes16 map(const Function& f) const {
    Lanes16 result;
    for (int i = 0; i < kParts; ++i) result.part[i] = f(part[i]);
    return result;
  }
  template <typename Function>
  static Lanes16 map2(const Lanes16& a, const Lanes16& b, const Function& f) {
    Lanes16 result;
    for (int i = 0; i < kParts; ++i) result.part[i] = f(a.part[i], b.part[i]);
    return result;
  }
  template <typename Function>
  static Mask compare(const Lanes16& a, const Lanes16& b, const Function& f) {
    Mask result;
    for (int i = 0; i < kParts; ++i) result.part[i] = f(a.part[i], b.part[i]);
    return result;
  }
};

/// Element by element.
template <typename To, typename From>
[[nodiscard]] inline Lanes16<To> converted(const Lanes16<From>& v) {
  Lanes16<To> result;
  for (int i = 0; i < Lanes16<To>::kParts; ++i)
    result.part[i] = __builtin_convertvector(v.part[i], typename Lanes16<To>::Part);
  return result;
}

template <typename Element>
[[nodiscard]] inline Lanes16<Element> chosen(const Lanes16<std::int32_t>& mask, const Lanes16<Element>& yes,
                                             const Lanes16<Element>& no) {
  Lanes16<Element> result;
  for (int i = 0; i < Lanes16<Element>::kParts; ++i) result.part[i] = mask.part[i] ? yes.part[i] : no.part[i];
  return result;
}

}  // namespace vrc
