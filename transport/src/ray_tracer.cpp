// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/ray_tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>

#include "core/error.h"

namespace vrc {
namespace {

/// Debian's Embree asserts on NaN and on huge numbers, so such rays never reach it.
I16 traceable(I16 active, const Ray16& ray) {
  constexpr float kHuge = 1e18f;
  const auto sane = [](F16 v) { return abs(v) < kHuge; };  // false for NaN
  return active & sane(ray.origin.x) & sane(ray.origin.y) & sane(ray.origin.z) & sane(ray.direction.x) &
         sane(ray.direction.y) & sane(ray.direction.z) & (ray.t_max > 0.0f);
}

/// Lanes that are not to be traced hold zeros: with AVX2, Embree looks at them all the same.
template <typename EmbreeRay>
void store_ray(EmbreeRay& out, I16 valid, const Ray16& ray) {
  const auto put = [](float* to, F16 v) { __builtin_memcpy(to, &v, sizeof(v)); };
  const auto put_valid = [&](float* to, F16 v) { put(to, select(valid, v, F16{})); };
  put_valid(out.org_x, ray.origin.x);
  put_valid(out.org_y, ray.origin.y);
  put_valid(out.org_z, ray.origin.z);
  put_valid(out.dir_x, ray.direction.x);
  put_valid(out.dir_y, ray.direction.y);
  put_valid(out.dir_z, ray.direction.z);
  put_valid(out.tfar, ray.t_max);
  put(out.tnear, F16{});
  put(out.time, F16{});
  std::fill_n(out.mask, kLanes, ~0u);
  std::fill_n(out.flags, kLanes, 0u);
}

RTCIntersectContext make_context(RayTracer::Coherence coherence) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == RayTracer::Coherence::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

}  // namespace

struct RayTracer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayTracer::RayTracer(std::span<const float> positions, std::span<const std::uint32_t> indices)
    : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice(nullptr);
  VRC_CHECK(impl_->device != nullptr, "Embree device error {}", static_cast<int>(rtcGetDeviceError(nullptr)));
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_HIGH);

  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), positions.size() / 3));
  auto* triangles = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), indices.size() / 3));
  VRC_CHECK(vertices != nullptr && triangles != nullptr, "Embree could not allocate {} triangles",
            indices.size() / 3);
  std::ranges::copy(positions, vertices);
  std::ranges::copy(indices, triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
  const RTCError error = rtcGetDeviceError(impl_->device);
  VRC_CHECK(error == RTC_ERROR_NONE, "Embree error {} while building the scene", static_cast<int>(error));
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

Hit16 RayTracer::intersect(I16 active, const Ray16& ray, Coherence coherence) const {
  alignas(64) const I16 valid = traceable(active, ray);
  alignas(64) RTCRayHit16 rays;
  store_ray(rays.ray, valid, ray);
  std::fill_n(rays.hit.geomID, kLanes, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(rays.hit.instID[0], kLanes, RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context = make_context(coherence);
  rtcIntersect16(reinterpret_cast<const int*>(&valid), impl_->scene, &context, &rays);

  Hit16 hit;
  I16 geometry;
  __builtin_memcpy(&geometry, rays.hit.geomID, sizeof(geometry));
  __builtin_memcpy(&hit.triangle, rays.hit.primID, sizeof(hit.triangle));
  __builtin_memcpy(&hit.t, rays.ray.tfar, sizeof(hit.t));
  __builtin_memcpy(&hit.u, rays.hit.u, sizeof(hit.u));
  __builtin_memcpy(&hit.v, rays.hit.v, sizeof(hit.v));
  hit.hit = valid & (geometry == 0);
  hit.triangle = select(hit.hit, hit.triangle, I16{});
  return hit;
}

I16 RayTracer::occluded(I16 active, const Ray16& ray, Coherence coherence) const {
  alignas(64) const I16 valid = traceable(active, ray);
  alignas(64) RTCRay16 rays;
  store_ray(rays, valid, ray);
  RTCIntersectContext context = make_context(coherence);
  rtcOccluded16(reinterpret_cast<const int*>(&valid), impl_->scene, &context, &rays);
  F16 t;
  __builtin_memcpy(&t, rays.tfar, sizeof(t));
  return valid & (t < 0.0f);  // Embree sets tfar to -infinity
}

}  // namespace vrc
