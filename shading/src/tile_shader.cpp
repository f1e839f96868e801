// SPDX-License-Identifier: GPL-3.0-or-later
#include "tile_shader.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "core/hash.h"
#include "shading/interpolate.h"

namespace vrc {
namespace {

constexpr int kDirectSamplesWithCache = 4;  // light samples per camera sample where the rest has no noise

float masked_sum(I16 mask, F16 v) { return lane_sum(select(mask, v, F16{})); }

void add_to(float* pixel, I16 mask, const V3x16& v) {
  pixel[0] += masked_sum(mask, v.x);
  pixel[1] += masked_sum(mask, v.y);
  pixel[2] += masked_sum(mask, v.z);
}

}  // namespace

Layers::Layers(bool errors, bool aovs) {
  if (errors) {
    error = static_cast<int>(names.size());
    names.push_back("error.Y");
  }
  if (!aovs) return;
  albedo = static_cast<int>(names.size());
  normal = albedo + 3;
  depth = normal + 3;
  names.insert(names.end(), {"albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "depth.Z"});
}

struct TileShader::Packet {
  const LightSources& sources;
  const Tile& tile;
  const TileRecords* records;  // null: none
  std::size_t index;           // in the tile

  [[nodiscard]] const CameraPacket& camera() const { return tile.packets[index]; }
  [[nodiscard]] const SurfacePoint16& points() const { return tile.points[index]; }
};

TileShader::TileShader(const Scene& scene, const RenderOptions& options, const FilmSampler& film,
                       const Layers& layers, const RunControl& control)
    : scene_(scene),
      options_(options),
      film_(film),
      layers_(layers),
      control_(control),
      wants_direct_(options.only != Component::kIndirect),
      wants_indirect_(options.only != Component::kDirect && options.method != Method::kDirect &&
                      options.bounces != 0) {}

int TileShader::further_edge_samples(ShadingEffort effort) const {
  const bool wanted = options_.method == Method::kCache && options_.cache.supersample_edges;
  return wanted && effort == ShadingEffort::kFull ? vrc::further_edge_samples(options_.samples_per_pixel) : 0;
}

int TileShader::light_samples(ShadingEffort effort) const {
  if (effort == ShadingEffort::kOneLightSample) return 1;
  if (options_.light_samples > 0) return options_.light_samples;
  return options_.method == Method::kCache ? kDirectSamplesWithCache : 1;
}

void TileShader::shade(const std::vector<Pixel>& pixels, const LightSources& sources, Image& image,
                       std::span<PixelFacts> facts, RayCounts& counts) const {
  const auto facts_of = [&](const Pixel& p) -> PixelFacts& { return facts[facts_index(scene_.camera(), p)]; };
  PixelGatherer::Surfaces surfaces;
  const std::vector<Pixel> edges = for_each_traced(
      scene_, film_, pixels, further_edge_samples(sources.effort), counts, [&](const Tile& tile) {
        std::optional<TileRecords> records;
        if (sources.cache != nullptr) records.emplace(*sources.cache, tile);
        Packet packet = {sources, tile, records ? &*records : nullptr, 0};
        for (const Pixel& p : tile.pixels) {
          float* pixel = image.pixel(p.x, p.y);
          for (int k = 0; k < tile.packets_per_pixel && !control_.stopped(); ++k, ++packet.index) {
            shade(packet, pixel, facts_of(p), counts);
            facts_of(p).samples += static_cast<int>(lane_count(packet.camera().active));
            if (sources.gatherer != nullptr) add_gathered(packet, surfaces, pixel, counts);
          }
        }
      });
  for (const Pixel& p : edges) facts_of(p).sees_edge = true;
  for (const Pixel& p : pixels) {
    PixelFacts& f = facts_of(p);
    f.finish();
    const float scale = 1.0f / static_cast<float>(std::max(f.samples, 1));
    for (std::size_t c = 3; c < layers_.names.size(); ++c) image.pixel(p.x, p.y)[c] *= scale;
  }
}

void TileShader::shade(const Packet& packet, float* pixel, PixelFacts& facts, RayCounts& counts) const {
  if (options_.method == Method::kPath) {
    const bool indirect = wants_indirect_ && packet.sources.gatherer == nullptr;
    if (indirect || wants_direct_) add_paths(packet, options_.bounces, indirect, pixel, counts);
  } else {
    if (wants_direct_) add_paths(packet, 0, false, pixel, counts);
    if (packet.records != nullptr) {
      Interpolated16 light = interpolate(*packet.records, packet.index, options_.cache.taylor_order,
                                         options_.cache.blend_support);
      if (packet.sources.paths_where_open && any(light.open)) trace_open(packet, light, counts);
      add_to(pixel + layers_.indirect, packet.points().scatters, light.radiance);
      facts.add(packet.points(), light);
    }
  }
  if (options_.aovs) add_aovs(packet, pixel);
}

void TileShader::add_paths(const Packet& packet, int bounces, bool indirect, float* pixel,
                           RayCounts& counts) const {
  const CameraPacket& camera = packet.camera();
  const int repeats = light_samples(packet.sources.effort);
  const float share = 1.0f / static_cast<float>(repeats);
  for (int i = 0; i < repeats; ++i) {
    const PathRadiance16 radiance =
        trace_paths(scene_, packet.points(), camera.direction, camera.active, sampler(camera, i),
                    {bounces, indirect, wants_direct_}, counts);
    add_to(pixel + layers_.direct, camera.active, radiance.direct * share);
    add_to(pixel + layers_.indirect, camera.active, radiance.indirect * share);
  }
}

/// A path from each point that no record reaches.
void TileShader::trace_open(const Packet& packet, Interpolated16& light, RayCounts& counts) const {
  const CameraPacket& camera = packet.camera();
  const PathOptions path = {options_.bounces, true, false};
  const V3x16 radiance = trace_paths(scene_, packet.points(), camera.direction, light.open,
                                     sampler(camera, light_samples(packet.sources.effort)), path, counts)
                             .indirect;
  light.radiance = select(light.open, radiance, light.radiance);
  // Paths err independently: the variance of their mean is at most their mean square over their number.
  const F16 y = luminance(radiance);
  light.squared_error = select(light.open, y * y * (1.0f / static_cast<float>(options_.samples_per_pixel)),
                               light.squared_error);
}

/// Guided rays from a packet's points instead of the rest of its paths.
void TileShader::add_gathered(const Packet& packet, PixelGatherer::Surfaces& surfaces, float* pixel,
                              RayCounts& counts) const {
  const CameraPacket& camera = packet.camera();
  const int rays = std::max(options_.path_rays / film_.packets_per_pixel(), 1 << kFewestLog2PixelRays);
  const std::array<double, 3> radiance =
      packet.sources.gatherer->gather({&packet.points(), 1}, std::bit_width(static_cast<unsigned>(rays - 1)),
                                      hash(camera.pixel_seed[0], camera.sample_index[0]), surfaces, counts);
  for (int c = 0; c < 3; ++c)
    pixel[layers_.indirect + c] += static_cast<float>(radiance[static_cast<std::size_t>(c)]);
}

/// Repetition `i` of a sample continues the pixel's sequence.
PathSampler16 TileShader::sampler(const CameraPacket& packet, int i) const {
  const int most = options_.samples_per_pixel + vrc::further_edge_samples(options_.samples_per_pixel);
  return {packet.sample_index + static_cast<std::uint32_t>(i * most), packet.pixel_seed ^ 0x1b56c4e9u};
}

void TileShader::add_aovs(const Packet& packet, float* pixel) const {
  const SurfacePoint16& p = packet.points();
  for_each_distinct(p.hit, p.material, [&](I16 mask, std::size_t id) {
    add_to(pixel + layers_.albedo, mask, splat3(scene_.bsdfs()[id].albedo()));
  });
  add_to(pixel + layers_.normal, p.hit, p.normal);
  const F16 depth = p.t * dot(packet.camera().direction, splat3(scene_.camera().forward));
  pixel[layers_.depth] += masked_sum(p.hit, depth);
}

}  // namespace vrc
