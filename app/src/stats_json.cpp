// SPDX-License-Identifier: GPL-3.0-or-later
#include "stats_json.h"

#include <nlohmann/json.hpp>

#include "app/progress.h"
#include "app/version.h"

namespace vrc {

std::uint64_t total_rays(const RenderStats& stats) {
  return stats.gather_rays + stats.shadow_rays + stats.camera_rays + stats.other_rays;
}

double rays_per_second(const RunReport& report) {
  const auto rays = static_cast<double>(total_rays(report.stats));
  return report.render_seconds > 0.0 ? rays / report.render_seconds : 0.0;
}

std::string_view name_of(Method method) {
  switch (method) {
    case Method::kCache:
      return "cache";
    case Method::kPath:
      return "path";
    case Method::kDirect:
      return "direct";
  }
  VRC_CHECK(false, "method {}", static_cast<int>(method));
}

std::string_view name_of(Component component) {
  switch (component) {
    case Component::kFull:
      return "full";
    case Component::kDirect:
      return "direct";
    case Component::kIndirect:
      return "indirect";
  }
  VRC_CHECK(false, "component {}", static_cast<int>(component));
}

RecordClasses count_classes(std::span<const RadianceRecord> records) {
  RecordClasses classes;
  for (const RadianceRecord& record : records) {
    ++classes.reasons[static_cast<std::size_t>(record.curvature.reason)];
    ++classes.harmonics[static_cast<std::size_t>(record.harmonics_reason)];
    if (record.curvature.needs_sh()) ++classes.needs_sh;
  }
  return classes;
}

namespace {

using Json = nlohmann::ordered_json;

/// File names may hold bytes that are no UTF-8; they are replaced rather than refused.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json json_of(const RunReport& report) {
  const RenderStats& stats = report.stats;
  Json phases = Json::array();
  for (const PhaseTime& phase : stats.phases) {
    phases.push_back({{"name", phase.name}, {"seconds", phase.seconds}, {"cpu_seconds", phase.cpu_seconds}});
  }
  Json reasons = Json::object();
  for (std::size_t i = 0; i < kCurvatureReasons; ++i) {
    reasons[std::string(name_of(static_cast<CurvatureReason>(i)))] = report.classes.reasons[i];
  }
  Json harmonics = Json::object();
  for (std::size_t i = 1; i < kHarmonicsReasons; ++i) {
    harmonics[std::string(name_of(static_cast<HarmonicsReason>(i)))] = report.classes.harmonics[i];
  }
  Json json{
      {"version", kVersion},
      {"scene", report.scene},
      {"command_line", report.command_line},
      {"method", name_of(report.options.method)},
      {"only", name_of(report.options.only)},
      {"width", report.width},
      {"height", report.height},
      {"spp", report.options.samples_per_pixel},
      {"bounces", report.options.bounces},
      {"seed", report.options.seed},
      {"threads", report.threads},
      {"unfinished", stats.unfinished},
      {"seconds", report.seconds},
      {"cpu_seconds", report.cpu_seconds},
      {"phases", std::move(phases)},
      {"records", stats.records},
      {"records_made", stats.records_made},
      {"records_of_sh", stats.records - report.classes.taylor()},
      {"records_of_sh_by_reason", std::move(harmonics)},
      {"records_needing_sh", report.classes.needs_sh},
      {"records_by_curvature", std::move(reasons)},
      {"hard_pixels", stats.hard_pixels},
      {"light_samples", stats.light_samples},
      {"edge_samples", stats.edge_samples},
      {"accepted_error", stats.error},
      {"records_error", stats.records_error},
      {"relative_error", stats.relative_error},
      {"gather_rays", stats.gather_rays},
      {"shadow_rays", stats.shadow_rays},
      {"camera_rays", stats.camera_rays},
      {"other_rays", stats.other_rays},
      {"rays_per_second", rays_per_second(report)},
      {"peak_memory_bytes", peak_memory_bytes()},
  };
  if (report.relmse) json["relmse"] = *report.relmse;
  return json;
}

}  // namespace

std::string stats_json(const RunReport& report) { return text_of(json_of(report)); }

std::string frames_json(std::span<const RunReport> frames) {
  Json list = Json::array();
  for (const RunReport& report : frames) list.push_back(json_of(report));
  return text_of(Json{{"frames", std::move(list)}});
}

std::string summary_line(const RunReport& report) {
  std::string line = fmt::format("{:.2f} s, {:.2f} CPU s", report.seconds, report.cpu_seconds);
  if (report.options.method == Method::kCache) {
    line += fmt::format(", {} records ({} of spherical harmonics)", report.stats.records,
                        report.stats.records - report.classes.taylor());
    if (report.stats.relative_error > 0.0)
      line += fmt::format(", estimated error {:.2g} %", 100.0 * report.stats.relative_error);
  }
  line +=
      fmt::format(", {}rays ({}rays/s), {} MB", short_count(static_cast<double>(total_rays(report.stats))),
                  short_count(rays_per_second(report)), peak_memory_bytes() >> 20);
  if (report.relmse) line += fmt::format(", relMSE {:.3e}", *report.relmse);
  return line;
}

}  // namespace vrc
