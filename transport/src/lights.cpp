// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/lights.h"

#include <algorithm>

#include "transport/bsdf.h"
#include "transport/lobes.h"

namespace vrc {

Lights::Lights(std::vector<EmissiveTriangle> triangles, std::vector<DeltaLight> delta_lights,
               const Rgb& environment, double scene_radius)
    : triangles_(std::move(triangles)),
      delta_lights_(std::move(delta_lights)),
      environment_(environment),
      far_(static_cast<float>(4.0 * scene_radius)) {
  const double disk = kPi * scene_radius * scene_radius;
  std::vector<double> powers;
  const auto add = [&](Kind kind, std::size_t index, double power) {
    if (power <= 0.0) return;
    entries_.push_back({kind, static_cast<std::uint32_t>(index), 0.0f, 0.0f, 0.0f});
    powers.push_back(power);
  };
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    add(Kind::kTriangle, i, kPi * triangles_[i].area * luminance(triangles_[i].radiance));
  }
  for (std::size_t i = 0; i < delta_lights_.size(); ++i) {
    if (const auto* point = std::get_if<PointLight>(&delta_lights_[i])) {
      add(Kind::kPoint, i, 4.0 * kPi * luminance(point->intensity));
    } else {
      add(Kind::kDirectional, i, disk * luminance(std::get<DirectionalLight>(delta_lights_[i]).irradiance));
    }
  }
  add(Kind::kEnvironment, 0, kPi * disk * luminance(environment_));

  double total = 0.0;
  for (const double p : powers) total += p;
  double sum = 0.0;
  triangle_probability_.assign(triangles_.size(), 0.0f);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& e = entries_[i];
    e.cdf_begin = static_cast<float>(sum / total);
    sum += powers[i];
    e.cdf_end = i + 1 == entries_.size() ? 1.0f : static_cast<float>(sum / total);
    e.probability = static_cast<float>(powers[i] / total);
    if (e.kind == Kind::kTriangle) triangle_probability_[e.index] = e.probability;
    if (e.kind == Kind::kEnvironment) environment_probability_ = e.probability;
  }
}

Lights::Chosen Lights::choose(F16 u1) const {
  Chosen result{};
  if (entries_.size() <= 16) {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const Entry& e = entries_[i];
      if (e.cdf_end <= e.cdf_begin) continue;
      const I16 inside = (u1 >= e.cdf_begin) & (u1 < e.cdf_end);
      result.entry = select(inside, splat(static_cast<std::int32_t>(i)), result.entry);
      result.u = select(inside, (u1 - e.cdf_begin) * (1.0f / (e.cdf_end - e.cdf_begin)), result.u);
    }
  } else {
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto it = std::ranges::upper_bound(entries_, u1[lane], {}, &Entry::cdf_end);
      const auto i =
          std::min<std::size_t>(static_cast<std::size_t>(it - entries_.begin()), entries_.size() - 1);
      const Entry& e = entries_[i];
      result.entry[lane] = static_cast<std::int32_t>(i);
      result.u[lane] = (u1[lane] - e.cdf_begin) / std::max(e.cdf_end - e.cdf_begin, 1e-30f);
    }
  }
  result.u = within_unit(result.u);
  return result;
}

void Lights::sample_triangle(const EmissiveTriangle& light, I16 mask, const V3x16& position, F16 u1, F16 u2,
                             float probability, LightSample16& out) const {
  const F16 root = sqrt(u1);
  const F16 b1 = root * (1.0f - u2), b2 = root * u2;
  const V3x16 point = splat3(light.p0) + splat3(light.e1) * b1 + splat3(light.e2) * b2;
  const V3x16 to_light = point - position;
  const F16 distance2 = max(dot(to_light, to_light), 1e-30f);
  const F16 distance = sqrt(distance2);
  const V3x16 direction = to_light * (1.0f / distance);
  const F16 cosine = -dot(direction, splat3(light.normal));
  const I16 facing = mask & (cosine > 0.0f);
  const F16 density = distance2 * (probability / light.area) / max(cosine, 1e-30f);
  out.valid = select(mask, facing, out.valid);
  out.direction = select(mask, direction, out.direction);
  out.distance = select(mask, distance, out.distance);
  out.radiance = select(mask, splat3(light.radiance) * (1.0f / density), out.radiance);
  out.pdf = select(mask, density, out.pdf);
}

LightSample16 Lights::sample(const V3x16& position, const V3x16& n, F16 u1, F16 u2) const {
  LightSample16 out{};
  out.direction = n;
  if (entries_.empty()) return out;
  const Chosen chosen = choose(u1);
  for_each_distinct(splat(-1), chosen.entry, [&](I16 mask, std::size_t id) {
    const Entry& e = entries_[id];
    switch (e.kind) {
      case Kind::kTriangle:
        sample_triangle(triangles_[e.index], mask, position, chosen.u, u2, e.probability, out);
        break;
      case Kind::kPoint: {
        const auto& light = std::get<PointLight>(delta_lights_[e.index]);
        const V3x16 to_light = splat3(light.position) - position;
        const F16 distance2 = max(dot(to_light, to_light), 1e-30f);
        const F16 distance = sqrt(distance2);
        out.valid = select(mask, mask, out.valid);
        out.direction = select(mask, to_light * (1.0f / distance), out.direction);
        out.distance = select(mask, distance, out.distance);
        out.radiance =
            select(mask, splat3(light.intensity) * (1.0f / (e.probability * distance2)), out.radiance);
        break;
      }
      case Kind::kDirectional: {
        const auto& light = std::get<DirectionalLight>(delta_lights_[e.index]);
        out.valid = select(mask, mask, out.valid);
        out.direction = select(mask, splat3(Vec3(-light.direction)), out.direction);
        out.distance = select(mask, splat(far_), out.distance);
        out.radiance = select(mask, splat3(light.irradiance) * (1.0f / e.probability), out.radiance);
        break;
      }
      case Kind::kEnvironment: {
        const F16 cosine = sqrt(1.0f - chosen.u);
        const F16 density = pdf_of_environment(cosine);
        out.valid = select(mask, mask & (cosine > 0.0f), out.valid);
        out.direction = select(mask, around_axis(n, cosine, u2), out.direction);
        out.distance = select(mask, splat(far_), out.distance);
        out.radiance = select(mask, splat3(environment_) * (1.0f / max(density, 1e-30f)), out.radiance);
        out.pdf = select(mask, density, out.pdf);
        break;
      }
    }
  });
  return out;
}

V3x16 Lights::emitted(I16 active, I16 light, const V3x16& direction) const {
  V3x16 result{};
  for_each_distinct(active, light, [&](I16 mask, std::size_t id) {
    const EmissiveTriangle& l = triangles_[id];
    const I16 facing = mask & (dot(direction, splat3(l.normal)) < 0.0f);
    result = select(facing, splat3(l.radiance), result);
  });
  return result;
}

F16 Lights::pdf_of_hit(I16 active, I16 light, const V3x16& direction, F16 distance) const {
  F16 result{};
  for_each_distinct(active, light, [&](I16 mask, std::size_t id) {
    const EmissiveTriangle& l = triangles_[id];
    const F16 cosine = max(-dot(direction, splat3(l.normal)), 1e-20f);
    result = select(mask, distance * distance * (triangle_probability_[id] / l.area) / cosine, result);
  });
  return result;
}

MetLight16 Lights::met(I16 active, I16 hit, I16 light, const V3x16& direction, F16 distance,
                       F16 cosine) const {
  MetLight16 result;
  const I16 on_light = active & hit & (light >= 0);
  if (any(on_light)) {
    result.valid = on_light;
    result.radiance = emitted(on_light, light, direction);
    result.pdf = pdf_of_hit(on_light, light, direction, distance);
  }
  const I16 missed = active & ~hit;
  if (any(missed) && environment_.maxCoeff() > 0.0f) {
    result.valid |= missed;
    result.radiance = select(missed, splat3(environment_), result.radiance);
    result.pdf = select(missed, pdf_of_environment(cosine), result.pdf);
  }
  return result;
}

F16 Lights::pdf_of_environment(F16 cosine) const {
  return max(cosine, 0.0f) * (environment_probability_ / kPiF);
}

}  // namespace vrc
