// SPDX-License-Identifier: GPL-3.0-or-later
// How right are derivatives of radiance beside occluders? Gathers are compared with finite differences of
// converged ones, at points of floors that something stands near of. What noise is left in these counts as
// error of the gathers.
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

namespace vrc::bench {
namespace {

constexpr int kGathers = 8;         // A converged estimate is the mean of this many.
constexpr int kReferenceLog2 = 16;  // rays of each that references are made of
constexpr std::uint64_t kFirstSeed = 100, kReferenceSeed = 1 << 20;
constexpr double kUpwards = 0.99;  // cosine of a floor's normal with y

struct Settings : PictureSettings {
  double nearest = 0.03, farthest = 0.09;  ///< Distances of occluders. [length]
  double step = 0.006;                     ///< Of finite differences, as a share of the scene's radius.
  int lattice = 3;                         ///< Pixels between candidates.
  std::vector<double> agreements = {0.3, 0.15};
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
  Vec2 film;  ///< As a share of the film's size.
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
    result.mean = result.mean + (1.0 / kGathers) * jets.back();
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

std::optional<Reference> reference_at(const Scene& scene, const RecordSite& site, const Settings& settings) {
  const double step = settings.step * scene.radius();
  const auto narrow = surface_stencil(scene, site, step), wide = surface_stencil(scene, site, 2.0 * step);
  if (!narrow || !wide) return std::nullopt;
  Variant converged;
  converged.options.log2_rays = kReferenceLog2;
  converged.options.occlusion_aware = false;  // concerns derivatives alone
  const auto value = [&](const RecordSite& s) {
    return sample([&](std::uint64_t seed) { return gather_by(scene, converged, s, seed); }, kReferenceSeed)
        .mean.value;
  };
  Reference r{differentiate(*narrow, value), differentiate(*wide, value), {}};
  r.extrapolated = richardson(r.narrow, r.wide);
  return r;
}

/// Points of floors.
std::vector<Point> points_beside_occluders(const Scene& scene, const Settings& settings) {
  std::vector<Vec2> film;
  for (int y = settings.lattice / 2; y < settings.height; y += settings.lattice)
    for (int x = settings.lattice / 2; x < settings.width; x += settings.lattice)
      film.emplace_back(x + 0.5, y + 0.5);
  std::vector<std::optional<Point>> found(film.size());
  parallel_for(film.size(), [&](std::size_t i) {
    const auto point = scene.seen_at(film[i][0], film[i][1]);
    if (!point || point->normal.y() < kUpwards) return;
    const RecordSite site = make_site(scene, *point, i);
    const auto distance = occluder_distance(scene, site);
    if (!distance || *distance < settings.nearest || *distance > settings.farthest) return;
    const auto reference = reference_at(scene, site, settings);
    if (!reference) return;
    const Vec2 share(film[i][0] / settings.width, film[i][1] / settings.height);
    found[i] = Point{share, site, *distance, *reference};
  });
  std::vector<Point> points;
  for (const auto& p : found)
    if (p) points.push_back(*p);
  return points;
}

/// Squared errors of means and variances of single gathers over the squares of the truth, of many points.
class RelativeErrors {
 public:
  void add(double squared_difference, double variance, double squared_truth) {
    // The mean's own noise is no bias.
    const double error = squared_difference - variance / kGathers;
    error_ += error;
    variance_ += variance;
    truth_ += squared_truth;
    ratios_.push_back(root(error / squared_truth));
  }
  [[nodiscard]] double bias() const { return root(error_ / truth_); }
  [[nodiscard]] double median_bias() const { return median(ratios_); }
  [[nodiscard]] double deviation() const { return root(variance_ / truth_); }

 private:
  static double root(double v) { return std::sqrt(std::max(v, 0.0)); }

  double error_ = 0.0, variance_ = 0.0, truth_ = 0.0;
  std::vector<double> ratios_;
};

struct DerivativeErrors {
  RelativeErrors gradient, hessian;

  void add(const Jet2& truth, const Sample& s) {
    gradient.add((s.mean.gradient - truth.gradient).squaredNorm(), s.gradient_variance,
                 truth.gradient.squaredNorm());
    hessian.add((s.mean.hessian - truth.hessian).squaredNorm(), s.hessian_variance,
                truth.hessian.squaredNorm());
  }
};

std::vector<Variant> variants() {
  std::vector<Variant> result(4);
  result[0].name = "hits fixed, 2^15";
  result[0].options.occlusion_aware = false;
  result[0].options.log2_rays = 15;
  result[1].name = "2^15";
  result[1].options.log2_rays = 15;
  result[2].name = "2^12";
  result[3].name = "guided, 2^13";
  result[3].options.log2_rays = 13;
  result[3].guided = true;
  return result;
}

void test_scene(const std::string& file, const Settings& settings) {
  const Scene scene(read_scene_for(file, settings));
  const std::vector<Point> points = points_beside_occluders(scene, settings);
  const std::string name = std::filesystem::path(file).stem().string();
  for (const Variant& variant : variants()) {
    std::vector<Sample> samples(points.size());
    parallel_for(points.size(), [&](std::size_t i) {
      samples[i] = sample([&](std::uint64_t seed) { return gather_by(scene, variant, points[i].site, seed); },
                          kFirstSeed);
    });
    for (const double agreement : settings.agreements) {
      DerivativeErrors errors;
      std::size_t count = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(points[i].reference.disagreement() <= agreement)) continue;  // nor where all is black
        errors.add(points[i].reference.extrapolated, samples[i]);
        ++count;
      }
      if (count == 0) continue;
      const auto row = [&](const RelativeErrors& e) {
        return fmt::format("{:>9.3f} {:>7.3f} {:>9.3f}", e.bias(), e.median_bias(), e.deviation());
      };
      fmt::print("{:18} {:18} {:>5g} {:>4}/{:<4} {} {}\n", name, variant.name, agreement, count,
                 points.size(), row(errors.gradient), row(errors.hessian));
      std::fflush(stdout);
    }
    if (!settings.list) continue;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point& p = points[i];
      DerivativeErrors errors;
      errors.add(p.reference.extrapolated, samples[i]);
      fmt::print("  film {:.4f} {:.4f}, occluder at {:.3f}, steps differ by {:.2f}: {:.3f} {:.3f}\n",
                 p.film[0], p.film[1], p.distance, p.reference.disagreement(), errors.gradient.bias(),
                 errors.hessian.bias());
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
  declare_scene_options(app, settings);
  app.add_option("--nearest", settings.nearest, "Least distance of occluders")->capture_default_str();
  app.add_option("--farthest", settings.farthest, "Largest distance of occluders")->capture_default_str();
  app.add_option("--step", settings.step, "Of finite differences, over the scene's radius")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--lattice", settings.lattice, "Pixels between candidates")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--agreement", settings.agreements,
                 "Points count whose differences by two steps agree this well")
      ->capture_default_str();
  app.add_flag("--list", settings.list, "Every point by itself, too");
  CLI11_PARSE(app, argc, argv);
  return run_reported("bench_silhouette_derivatives", settings, [&] {
    fmt::print("{:18} {:18} {:>5} {:>9} {:>27} {:>27}\n", "scene", "gathers", "steps", "points",
               "gradient: bias, median, dev.", "Hessian: bias, median, dev.");
    for (const std::string& scene : settings.scenes) test_scene(scene, settings);
  });
}
