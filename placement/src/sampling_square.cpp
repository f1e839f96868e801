// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling_square.h"

#include <algorithm>

namespace vrc {
namespace {

std::vector<GatherStrategy> make_strategies(const Bsdf& bsdf, GatherDirections directions) {
  using Kind = GatherStrategy::Kind;
  if (directions == GatherDirections::kUniform) return {{Kind::kUniform}};
  if (directions == GatherDirections::kCosine) return {{}};
  std::vector<const Lobe*> glossy;
  bool diffuse = false;
  for (const Lobe& lobe : bsdf.lobes) {
    if (std::holds_alternative<LambertLobe>(lobe))
      diffuse = true;
    else
      glossy.push_back(&lobe);
  }
  if (glossy.empty()) return {{}};
  const int count = std::min<int>(static_cast<int>(glossy.size()), 4);
  const int glossy_eighths = std::max(diffuse ? 2 : 4, count);
  std::vector<GatherStrategy> result = {
      {Kind::kCosine, nullptr, 0.0f, static_cast<float>(8 - glossy_eighths) / 8.0f}};
  for (int i = 0; i < count; ++i) {
    const float begin = result.back().end;
    const int share = (glossy_eighths * (i + 1)) / count - (glossy_eighths * i) / count;
    result.push_back(
        {Kind::kLobe, glossy[static_cast<std::size_t>(i)], begin, begin + static_cast<float>(share) / 8.0f});
  }
  return result;
}

}  // namespace

SamplingSquare::SamplingSquare(const Bsdf& bsdf, GatherDirections directions, const Vec3& normal,
                               const Vec3& to_camera)
    : bsdf_(&bsdf),
      strategies_(make_strategies(bsdf, directions)),
      normal_(splat3(normal)),
      to_camera_(splat3(to_camera)) {}

/// Most packets lie in the columns of one strategy.
V3x16 SamplingSquare::direction(F16 u1, F16 u2) const {
  V3x16 result{};
  for (const GatherStrategy& s : strategies_) {
    const I16 own = (u1 >= s.begin) & (u1 < s.end);
    if (any(own)) result = select(own, direction(s, u1, u2), result);
  }
  return result;
}

V3x16 SamplingSquare::direction(const GatherStrategy& s, F16 u1, F16 u2) const {
  const F16 stretched = within_unit((u1 - s.begin) * (1.0f / (s.end - s.begin)));
  switch (s.kind) {
    case GatherStrategy::Kind::kCosine:
      return sample(LambertLobe{}, normal_, to_camera_, stretched, u2);
    case GatherStrategy::Kind::kUniform:
      return around_axis(normal_, 1.0f - stretched, u2);
    case GatherStrategy::Kind::kLobe:
      break;
  }
  return std::visit([&](const auto& l) { return sample(l, normal_, to_camera_, stretched, u2); }, *s.lobe);
}

F16 SamplingSquare::pdf(const GatherStrategy& s, const Directions16& d) const {
  switch (s.kind) {
    case GatherStrategy::Kind::kCosine:
      return vrc::pdf(LambertLobe{}, d);
    case GatherStrategy::Kind::kUniform:
      return splat(static_cast<float>(0.5 / kPi));
    case GatherStrategy::Kind::kLobe:
      break;
  }
  return std::visit([&](const auto& l) { return vrc::pdf(l, d); }, *s.lobe);
}

SampleInverse SamplingSquare::inverse(const GatherStrategy& s) const {
  return inverse_of_sample(s.kind == GatherStrategy::Kind::kLobe ? *s.lobe : Lobe(LambertLobe{}), normal_,
                           to_camera_);
}

F16 SamplingSquare::pdf(const Directions16& d) const {
  F16 sum{};
  for (const GatherStrategy& s : strategies_) sum += (s.end - s.begin) * pdf(s, d);
  return sum;
}

}  // namespace vrc
