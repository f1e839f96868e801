// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/derivative_images.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "core/hash.h"
#include "core/parallel.h"
#include "core/timing.h"
#include "placement/harmonics_derivatives.h"
#include "placement/record_factory.h"
#include "placement/surface_differences.h"

namespace vrc {
namespace {

constexpr std::uint64_t kSiteKey = 0xde51u, kReferenceKey = 0x4ef5u;

WorldDerivatives to_world(const Jet2& jet, const Frame& frame) {
  Eigen::Matrix<double, 3, 2> tangents;
  tangents << frame.tangent, frame.bitangent;
  return {(tangents * jet.gradient).cast<float>(),
          (tangents * jet.hessian * tangents.transpose()).cast<float>()};
}

/// What one pixel gives.
struct PixelEstimate {
  std::array<WorldDerivatives, kDerivativeMethods> derivatives;
  std::array<double, kDerivativeMethods> cpu_seconds{};
};

class Estimator {
 public:
  Estimator(const Scene& scene, const DerivativeOptions& options)
      : scene_(scene),
        step_(options.step > 0.0 ? options.step : DerivativeOptions::kStepShare * scene.camera().width),
        gatherer_(options.harmonics_order > 0 ? options.harmonics_order : harmonics_order_for(scene.bsdfs())),
        brdfs_(scene.bsdfs(), gatherer_.order()) {
    gather_.log2_rays = options.log2_rays;
    gather_.bounces = options.bounces;
    gather_.seed = options.seed;
    flat_reflectors_ = gather_;
    flat_reflectors_.glossy_glossy = false;
    // Random numbers of its own: errors hold the noise of both sides.
    reference_ = gather_;
    reference_.log2_rays = options.log2_reference_rays;
    reference_.seed = hash(options.seed, kReferenceKey);
  }

  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] int order() const { return gatherer_.order(); }

  /// Nothing for an invalid pixel.
  [[nodiscard]] std::optional<PixelEstimate> estimate(int x, int y, RayCounts& counts) const {
    const std::optional<RecordSite> site = site_at(x, y, counts);
    if (!site) return std::nullopt;
    std::optional<SurfaceStencil> stencil = surface_stencil(scene_, *site, step_ * site->pixel_length);
    if (!stencil) return std::nullopt;
    PixelEstimate result;
    const auto run = [&](DerivativeMethod method, const auto& jet_of) {
      const double start = thread_cpu_seconds();
      const Jet2 jet = jet_of();
      const auto m = static_cast<std::size_t>(method);
      result.cpu_seconds[m] = thread_cpu_seconds() - start;
      result.derivatives[m] = to_world(jet, site->frame);
    };
    double nearest = 0.0;
    run(DerivativeMethod::kAnalytic, [&] {
      const RadianceEstimate estimate = gather_radiance(scene_, *site, gather_, counts);
      nearest = estimate.hits.nearest;
      return estimate.luminance;
    });
    const double limit = DerivativeOptions::kNearestShare * nearest;
    if (limit < stencil->step) stencil = surface_stencil(scene_, *site, limit);
    if (!stencil) return std::nullopt;
    run(DerivativeMethod::kNoGlossyGlossy,
        [&] { return gather_radiance(scene_, *site, flat_reflectors_, counts).luminance; });
    // Its tables are made when it is first asked for.
    const BrdfHarmonics& brdf = brdfs_.of(static_cast<std::size_t>(site->point.material));
    run(DerivativeMethod::kHarmonics, [&] {
      HitDistances hits;
      const IncidentHarmonics incident = gatherer_.gather(scene_, *site, gather_, counts, hits);
      return luminance(outgoing_radiance(incident, moving_weights(brdf, *site, order())));
    });
    run(DerivativeMethod::kFiniteDifferences, [&] {
      return differentiate(*stencil, [&](const RecordSite& s) {
        return gather_radiance(scene_, s, reference_, counts).luminance.value;
      });
    });
    return result;
  }

 private:
  /// The reflecting surface behind the centre of a pixel.
  [[nodiscard]] std::optional<RecordSite> site_at(int x, int y, RayCounts& counts) const {
    ++counts.camera;
    const std::optional<SurfacePoint> point = scene_.seen_at(x + 0.5, y + 0.5);
    if (!point) return std::nullopt;
    return make_site(scene_, *point, hash(kSiteKey, x, y));
  }

  const Scene& scene_;
  double step_;
  HarmonicsGatherer gatherer_;
  BrdfHarmonicsSet brdfs_;
  GatherOptions gather_, flat_reflectors_, reference_;
};

/// Calls body(row) for all rows of the window and reports the progress.
template <typename Body>
void for_each_row(const CropWindow& window, const RunControl& control, const Body& body) {
  const auto rows = static_cast<std::size_t>(window.y1 - window.y0);
  std::atomic<std::size_t> done{0};
  std::mutex reporting;
  control.report({"derivatives", 0.0, 0, 0});
  parallel_for(rows, [&](std::size_t row) {
    body(window.y0 + static_cast<int>(row));
    done.fetch_add(1);
    if (const std::unique_lock lock(reporting, std::try_to_lock); lock) {
      control.report({"derivatives", static_cast<double>(done.load()) / static_cast<double>(rows), 0, 0});
    }
  });
  if (control.stopped()) throw Interrupted();
}

}  // namespace

std::string_view name_of(DerivativeMethod method) {
  switch (method) {
    case DerivativeMethod::kAnalytic:
      return "analytic";
    case DerivativeMethod::kNoGlossyGlossy:
      return "no-glossy-glossy";
    case DerivativeMethod::kHarmonics:
      return "sh";
    case DerivativeMethod::kFiniteDifferences:
      return "finite-differences";
  }
  VRC_CHECK(false, "method {}", static_cast<int>(method));
}

std::size_t DerivativeImages::valid_count() const {
  return static_cast<std::size_t>(std::ranges::count(valid, 1));
}

DerivativeImages estimate_derivatives(const Scene& scene, const DerivativeOptions& options,
                                      const RunControl& control) {
  const Camera& camera = scene.camera();
  const Estimator estimator(scene, options);
  DerivativeImages images;
  images.width = camera.width;
  images.height = camera.height;
  images.harmonics_order = estimator.order();
  images.step = estimator.step();
  const auto width = static_cast<std::size_t>(camera.width), height = static_cast<std::size_t>(camera.height);
  images.valid.resize(width * height);
  for (auto& method : images.methods) method.resize(width * height);

  struct RowTotals {
    RayCounts counts;
    std::array<double, kDerivativeMethods> cpu_seconds{};
  };
  std::vector<RowTotals> totals(height);
  const CropWindow window = options.crop.value_or(CropWindow{0, 0, camera.width, camera.height});
  for_each_row(window, control, [&](int y) {
    RowTotals& row = totals[static_cast<std::size_t>(y)];
    for (int x = window.x0; x < window.x1 && !control.stopped(); ++x) {
      const std::optional<PixelEstimate> estimate = estimator.estimate(x, y, row.counts);
      if (!estimate) continue;
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      images.valid[pixel] = 1;
      for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
        images.methods[m][pixel] = estimate->derivatives[m];
        row.cpu_seconds[m] += estimate->cpu_seconds[m];
      }
    }
  });
  for (const RowTotals& row : totals) {
    images.counts += row.counts;
    for (std::size_t m = 0; m < kDerivativeMethods; ++m) images.cpu_seconds[m] += row.cpu_seconds[m];
  }
  return images;
}

}  // namespace vrc
