// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/surface_differences.h"

namespace vrc {

std::optional<RecordSite> displaced_site(const Scene& scene, const RecordSite& site, const Vec2& d) {
  const double height = d.norm();
  if (height == 0.0) return site;
  const Vec3 from = site.point.position + d[0] * site.frame.tangent + d[1] * site.frame.bitangent +
                    height * site.frame.normal;
  I16 first{};
  first[0] = -1;
  const Ray16 ray = {splat3(from), splat3(Vec3(-site.frame.normal)), splat(static_cast<float>(2.0 * height))};
  const SurfacePoint16 p = scene.intersect(first, ray, RayTracer::Coherence::kIncoherent);
  if (p.scatters[0] == 0 || p.region[0] != site.point.region) return std::nullopt;
  const SurfacePoint point =
      scene.surface_point(static_cast<std::uint32_t>(p.triangle[0]), p.u[0], p.v[0], scene.camera().origin);
  if (point.normal.dot(site.frame.normal) <= 0.0) return std::nullopt;
  return make_site(scene, point, site.key);
}

std::optional<SurfaceStencil> surface_stencil(const Scene& scene, const RecordSite& site, double step) {
  SurfaceStencil stencil{step, {}};
  for (std::size_t i = 0; i < kDifferenceStencil.size(); ++i) {
    const auto [i1, i2] = kDifferenceStencil[i];
    const std::optional<RecordSite> moved = displaced_site(scene, site, {step * i1, step * i2});
    if (!moved) return std::nullopt;
    stencil.sites[i] = *moved;
  }
  return stencil;
}

Jet2 differentiate(const SurfaceStencil& stencil, const std::function<double(const RecordSite&)>& f) {
  StencilValues<double> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(stencil.sites[i]);
  const auto [value, d1, d2, d11, d12, d22] = central_differences(values, stencil.step, stencil.step);
  Jet2 jet;
  jet.value = value;
  jet.gradient = {d1, d2};
  jet.hessian << d11, d12, d12, d22;
  return jet;
}

Jet2 richardson(const Jet2& narrow, const Jet2& wide) {
  return {narrow.value, (4.0 * narrow.gradient - wide.gradient) / 3.0,
          (4.0 * narrow.hessian - wide.hessian) / 3.0};
}

}  // namespace vrc
