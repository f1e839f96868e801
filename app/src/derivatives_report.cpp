// SPDX-License-Identifier: GPL-3.0-or-later
#include "derivatives_report.h"

#include <nlohmann/json.hpp>

#include "app/version.h"
#include "core/timing.h"

namespace vrc {
namespace {

using Json = nlohmann::ordered_json;

/// What one method gave.
struct MethodSummary {
  DerivativeError gradient, hessian;
  double seconds_per_record = 0.0, cost_ratio = 0.0;
};

MethodSummary summarize(const DerivativeImages& images, DerivativeMethod method) {
  const auto seconds = [&](DerivativeMethod m) { return images.cpu_seconds[static_cast<std::size_t>(m)]; };
  const auto ratio = [](double a, double b) { return b > 0.0 ? a / b : 0.0; };
  return {gradient_error(images, method), hessian_error(images, method),
          ratio(seconds(method), static_cast<double>(images.valid_count())),
          ratio(seconds(method), seconds(DerivativeMethod::kAnalytic))};
}

Json as_json(const DerivativeError& error) {
  return {{"relative_rms", error.relative_rms}, {"median_relative", error.median_relative}};
}

}  // namespace

std::string derivatives_json(const DerivativesReport& report, const DerivativeImages& images) {
  Json methods = Json::object();
  for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
    const auto method = static_cast<DerivativeMethod>(m);
    const MethodSummary summary = summarize(images, method);
    methods[std::string(name_of(method))] = {{"gradient", as_json(summary.gradient)},
                                             {"hessian", as_json(summary.hessian)},
                                             {"cpu_seconds_per_record", summary.seconds_per_record},
                                             {"cost_ratio", summary.cost_ratio}};
  }
  const Json json{
      {"version", kVersion},
      {"scene", report.scene},
      {"command_line", report.command_line},
      {"width", images.width},
      {"height", images.height},
      {"bounces", report.options.bounces},
      {"seed", report.options.seed},
      {"threads", report.threads},
      {"gather_rays", 1 << report.options.log2_rays},
      {"reference_rays", 1 << report.options.log2_reference_rays},
      {"sh_order", images.harmonics_order},
      {"step", images.step},
      {"valid_pixels", images.valid_count()},
      {"rays", images.counts.camera + images.counts.gather + images.counts.shadow + images.counts.other},
      {"gradient_scale", report.gradient_scale},
      {"hessian_scale", report.hessian_scale},
      {"methods", std::move(methods)},
      {"seconds", report.seconds},
      {"cpu_seconds", report.cpu_seconds},
      {"peak_memory_bytes", peak_memory_bytes()},
  };
  // File names may hold bytes that are no UTF-8; they are replaced rather than refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string derivatives_table(const DerivativeImages& images) {
  std::string text = fmt::format("{:<20}{:>12}{:>10}{:>14}{:>10}{:>12}{:>8}\n", "", "gradient RMS", "median",
                                 "Hessian RMS", "median", "ms a record", "ratio");
  for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
    const auto method = static_cast<DerivativeMethod>(m);
    const MethodSummary s = summarize(images, method);
    const std::string cost = fmt::format("{:>12.3f}{:>8.2f}\n", 1e3 * s.seconds_per_record, s.cost_ratio);
    if (method == DerivativeMethod::kFiniteDifferences) {
      text += fmt::format("{:<20}{:>46}{}", name_of(method), "", cost);
    } else {
      text += fmt::format("{:<20}{:>12.4f}{:>10.4f}{:>14.4f}{:>10.4f}{}", name_of(method),
                          s.gradient.relative_rms, s.gradient.median_relative, s.hessian.relative_rms,
                          s.hessian.median_relative, cost);
    }
  }
  return text;
}

}  // namespace vrc
