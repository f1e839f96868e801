// SPDX-License-Identifier: GPL-3.0-or-later
// How right are derivatives of radiance beside occluders? Gathers are compared with finite differences of
// converged ones, at points of a scene that something stands near of.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench_support.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "placement/guide.h"
#include "placement/surface_differences.h"
#include "transport/film_sampler.h"

namespace vrc::bench {
namespace {

constexpr int kGathers = 8;  // A converged estimate is the mean of this many.
constexpr std::uint64_t kReferenceSeed = 1 << 20;

struct Settings : PictureSettings {
  double nearest = 0.03, farthest = 0.09;  // of the occluder [length]
  double step = 0.006;                     // of the finite differences, as a share of the scene's radius
  std::vector<double> agreements = {0.3, 0.15};
  int lattice = 3;         // pixels between candidates
  int reference_log2 = 16;
  bool list = false;

  Settings() {
    scenes = {VRC_SOURCE_DIR "/scenes/cornell_glossy.xml"};
    width = height = 256;
  }
};

/// Radiance and its derivatives by finite differences of two steps.
struct Reference {
  Jet2 narrow, wide;
  Jet2 extrapolated;

  /// How far the two steps' results differ, relative to the narrow one's.
  [[nodiscard]] double disagreement() const {
    return std::max((wide.gradient - narrow.gradient).norm() / narrow.gradient.norm(),
                    (wide.hessian - narrow.hessian).norm() / narrow.hessian.norm());
  }
};

struct Point {
  RecordSite site;
  double distance = 0.0;  ///< Of the occluder.
  Reference reference;
};

/// A way to gather.
struct Variant {
  std::string name;
  GatherOptions options;
  bool guided = false;  ///< By 2^12 rays of the site's own.
};

Jet2 gather_by(const Scene& scene, const Variant& variant, const RecordSite& site, std::uint64_t seed) {
  RayCounts counts;
  GatherOptions options = variant.options;
  if (!variant.guided) {
    options.seed = seed;
    return gather_radiance(scene, site, options, counts).luminance;
  }
  options.log2_rays = 12;
  options.seed = hash(seed, 1u);
  GuideHistogram found;
  (void)gather_radiance(scene, site, options, counts, {nullptr, &found});
  const KeptHistogram own(found);
  const auto warp = GuideField(scene).warp_at(site, &own);
  options.log2_rays = variant.options.log2_rays;
  options.seed = seed;
  return gather_radiance(scene, site, options, counts, {warp.get(), nullptr}).luminance;
}

/// The mean of gathers of independent seeds, and the mean square of their deviations.
struct Sample {
  Jet2 mean;
  double gradient_variance = 0.0, hessian_variance = 0.0;
};

Sample sample(const std::function<Jet2(std::uint64_t)>& gather, std::uint64_t first_seed) {
  std::vector<Jet2> jets;
  Sample result;
  for (int i = 0; i < kGathers; ++i) {
    jets.push_back(gather(first_seed + static_cast<std::uint64_t>(i)));
    result.mean.value += jets.back().value / kGathers;
    result.mean.gradient += jets.back().gradient / kGathers;
    result.mean.hessian += jets.back().hessian / kGathers;
  }
  for (const Jet2& j : jets) {
    result.gradient_variance += (j.gradient - result.mean.gradient).squaredNorm() / (kGathers - 1);
    result.hessian_variance += (j.hessian - result.mean.hessian).squaredNorm() / (kGathers - 1);
  }
  return result;
}

/// Nothing where no other surface is near, or the scene ends behind it, as it does behind walls.
std::optional<double> occluder_distance(const Scene& scene, const RecordSite& site) {
  RayCounts counts;
  GatherOptions options;
  options.directions = GatherDirections::kUniform;
  const HitDistances hits = gather_radiance(scene, site, options, counts).hits;
  if (!std::isfinite(hits.nearest)) return std::nullopt;
  const Vec3 behind =
      site.point.position + (hits.nearest + 4.0 * scene.ray_offset()) * hits.nearest_direction;
  I16 first{};
  first[0] = -1;
  const Ray16 ray = {splat3(behind), splat3(hits.nearest_direction), splat(1e17f)};
  if (scene.intersect(first, ray, RayTracer::Coherence::kIncoherent).hit[0] == 0) return std::nullopt;
  return hits.nearest;
}

std::optional<RecordSite> site_at(const Scene& scene, double x, double y, std::uint64_t key) {
  I16 first{};
  first[0] = -1;
  const Ray16 ray = {splat3(scene.camera().origin), splat3(scene.camera().direction(x, y)), splat(1e17f)};
  const SurfacePoint16 p = scene.intersect(first, ray, RayTracer::Coherence::kIncoherent);
  if (p.scatters[0] == 0) return std::nullopt;
  return make_site(scene,
                   scene.surface_point(static_cast<std::uint32_t>(p.triangle[0]), p.u[0], p.v[0],
                                       scene.camera().origin),
                   key);
}

std::optional<Reference> reference_at(const Scene& scene, const RecordSite& site, const Settings& settings) {
  const double step = settings.step * scene.radius();
  const auto narrow = surface_stencil(scene, site, step), wide = surface_stencil(scene, site, 2.0 * step);
  if (!narrow || !wide) return std::nullopt;
  Variant converged;
  converged.options.log2_rays = settings.reference_log2;
  const auto value = [&](const RecordSite& s) {
    return sample([&](std::uint64_t seed) { return gather_by(scene, converged, s, seed); }, kReferenceSeed)
        .mean.value;
  };
  Reference r{differentiate(*narrow, value), differentiate(*wide, value), {}};
  r.extrapolated = richardson(r.narrow, r.wide);
  return r;
}

std::vector<Point> points_beside_occluders(const Scene& scene, const Settings& settings) {
  std::vector<Vec2> film;
  for (int y = settings.lattice / 2; y < settings.height; y += settings.lattice)
    for (int x = settings.lattice / 2; x < settings.width; x += settings.lattice)
      film.emplace_back(x + 0.5, y + 0.5);
  std::vector<std::optional<Point>> found(film.size());
  parallel_for(film.size(), [&](std::size_t i) {
    const auto site = site_at(scene, film[i][0], film[i][1], i);
    if (!site || site->frame.normal.y() < 0.99) return;
    const auto distance = occluder_distance(scene, *site);
    if (!distance || *distance < settings.nearest || *distance > settings.farthest) return;
    const auto reference = reference_at(scene, *site, settings);
    if (reference) found[i] = Point{*site, *distance, *reference};
  });
  std::vector<Point> points;
  for (const auto& p : found)
    if (p) points.push_back(*p);
  return points;
}

double relative_rms(const std::vector<double>& squares, const std::vector<double>& sizes) {
  double a = 0.0, b = 0.0;
  for (const double s : squares) a += s;
  for (const double s : sizes) b += s;
  return std::sqrt(std::max(a / b, 0.0));
}

double median_ratio(const std::vector<double>& squares, const std::vector<double>& sizes) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < squares.size(); ++i) ratios.push_back(std::sqrt(std::max(squares[i], 0.0) / sizes[i]));
  return median(ratios);
}

void test_scene(const std::string& file, const Settings& settings) {
  const Scene scene(read_scene_for(file, settings));
  const std::vector<Point> points = points_beside_occluders(scene, settings);
  std::vector<Variant> variants(4);
  variants[0].name = "hits fixed, 2^15";
  variants[0].options.log2_rays = 15;
  variants[0].options.occlusion_aware = false;
  variants[1].name = "2^15";
  variants[1].options.log2_rays = 15;
  variants[2].name = "2^12";
  variants[3].name = "guided 2^13";
  variants[3].options.log2_rays = 13;
  variants[3].guided = true;
  std::vector<std::vector<Sample>> samples(variants.size(), std::vector<Sample>(points.size()));
  for (std::size_t v = 0; v < variants.size(); ++v)
    parallel_for(points.size(), [&](std::size_t i) {
      samples[v][i] =
          sample([&](std::uint64_t seed) { return gather_by(scene, variants[v], points[i].site, seed); }, 100);
    });
  for (const double agreement : settings.agreements) {
    for (std::size_t v = 0; v < variants.size(); ++v) {
      std::vector<double> g, h, gv, hv, g2, h2;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Reference& r = points[i].reference;
        if (r.disagreement() > agreement) continue;
        const Sample& s = samples[v][i];
        g2.push_back(r.extrapolated.gradient.squaredNorm());
        h2.push_back(r.extrapolated.hessian.squaredNorm());
        g.push_back((s.mean.gradient - r.extrapolated.gradient).squaredNorm() - s.gradient_variance / kGathers);
        h.push_back((s.mean.hessian - r.extrapolated.hessian).squaredNorm() - s.hessian_variance / kGathers);
        gv.push_back(s.gradient_variance);
        hv.push_back(s.hessian_variance);
        if (settings.list && v == 1)
          fmt::print("  {:3} at {:.3f}  g {:.3f} h {:.3f}  |H| {:.3g} disagreement {:.3f} pos {:.3f} {:.3f} {:.3f}\n", i,
                     points[i].distance, std::sqrt(g.back() / g2.back()), std::sqrt(h.back() / h2.back()),
                     std::sqrt(h2.back()), r.disagreement(), points[i].site.point.position.x(),
                     points[i].site.point.position.y(), points[i].site.point.position.z());
      }
      if (g.empty()) continue;
      fmt::print("{:18} {:.2f} {:4}/{:<4} {:20} bias {:.3f} {:.3f}  median {:.3f} {:.3f}  deviation {:.3f} {:.3f}\n",
                 std::filesystem::path(file).stem().string(), agreement, g.size(), points.size(), variants[v].name,
                 relative_rms(g, g2), relative_rms(h, h2), median_ratio(g, g2), median_ratio(h, h2),
                 relative_rms(gv, g2), relative_rms(hv, h2));
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace vrc::bench

int main(int argc, char** argv) {
  using namespace vrc;
  using namespace vrc::bench;
  Settings settings;
  CLI::App app("Derivatives beside occluders against finite differences");
  declare_picture_options(app, settings);
  app.add_option("--lattice", settings.lattice);
  app.add_option("--step", settings.step);
  app.add_option("--agreement", settings.agreements);
  app.add_option("--reference-log2", settings.reference_log2);
  app.add_flag("--list", settings.list);
  CLI11_PARSE(app, argc, argv);
  return run_reported("bench_silhouette_derivatives", settings, [&] {
    for (const std::string& scene : settings.scenes) test_scene(scene, settings);
  });
}
