// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_panel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/hash.h"
#include "core/image_error.h"
#include "core/image_structure.h"
#include "error_colors.h"
#include "figure_derivatives.h"
#include "figure_equal_time.h"
#include "io/display.h"
#include "io/image_io.h"
#include "panel_command.h"
#include "picture_file.h"
#include "render_arguments.h"
#include "scene_run.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

constexpr double kMeanLuminance = 0.5;  // that pictures are scaled to for relMSE

using RenderCommand = PanelCommand<RenderArguments>;

/// `extra` words come last.
RenderCommand command_of(const FigureGroup& group, const FigurePanel& panel, const std::string& extra,
                         const PanelPlace& place) {
  return panel_command("render", declare_render_options, group, panel.words + " " + extra, panel.id + ".exr",
                       place);
}

SceneRun run_whole(const RenderCommand& command, const std::atomic<bool>& stop) {
  check_render_arguments(command.arguments);
  SceneRun run = run_scene(command.arguments, command.text, stop, [](const SceneDescription&) {});
  if (run.result.stats.unfinished) throw Interrupted();
  return run;
}

NamedNumbers numbers_of(const RunReport& report, const RenderResult& result) {
  NamedNumbers numbers;
  if (report.options.method == Method::kCache) {
    const auto records = static_cast<double>(result.stats.records);
    const int rays = report.options.cache.gather_rays;
    numbers.emplace_back("records", records);
    numbers.emplace_back("gather_rays",
                         rays > 0 ? std::exp2(log2_rays_for(rays))
                                  : static_cast<double>(result.stats.gather_rays) / std::max(records, 1.0));
  }
  numbers.emplace_back("spp", report.options.samples_per_pixel);
  numbers.emplace_back("rays", static_cast<double>(total_rays(result.stats)));
  numbers.emplace_back("seconds", report.render_seconds);
  numbers.emplace_back("cpu_seconds", render_cpu_seconds(result));
  return numbers;
}

/// Writes the pictures of a panel, those of its records aside.
void write_pictures(const FigurePanel& panel, const PanelPlace& place, const RenderCommand& command,
                    const Image& image, const RunReport& report, PanelStamp& stamp) {
  stamp.files = {panel.id + ".exr", panel.id + ".png"};
  for (const std::string& file : stamp.files)
    write_picture(place.folder / file, image, command.arguments.display, report);
}

PanelStamp make_reference(const FigureGroup& group, const FigurePanel& panel, const PanelPlace& place,
                          const std::atomic<bool>& stop) {
  std::vector<Image> halves;
  std::vector<std::string> files;
  NamedNumbers numbers;
  RunReport report;
  for (const char* half : {"a", "b"}) {
    const RenderCommand command = command_of(group, panel, *half == 'a' ? "--seed 1" : "--seed 2", place);
    const SceneRun run = run_whole(command, stop);
    files.push_back(fmt::format("{}_{}.exr", panel.id, half));
    write_picture(place.folder / files.back(), run.result.image, command.arguments.display, run.report);
    halves.push_back(run.result.image);
    const NamedNumbers own = numbers_of(run.report, run.result);
    if (numbers.empty()) {
      numbers = own;
      report = run.report;
    } else {
      for (std::size_t i = 0; i < own.size(); ++i) numbers[i].second += own[i].second;
    }
  }
  const RenderCommand command = command_of(group, panel, "--seed 1", place);
  PanelStamp stamp;
  stamp.command = command.text;
  write_pictures(panel, place, command, mean_rgb(halves[0], halves[1]), report, stamp);
  stamp.files.insert(stamp.files.end(), files.begin(), files.end());
  stamp.numbers = numbers;
  return stamp;
}

/// Adds the files of the records.
void write_records(const FigurePanel& panel, const PanelPlace& place, const RenderArguments& given,
                   const RenderResult& result, PanelStamp& stamp) {
  if (!result.cache) return;
  RenderArguments arguments = given;
  const std::string map = panel.id + "_records.csv", overlay = panel.id + "_records.png";
  arguments.record_maps = {place.folder / map};
  arguments.record_overlay = place.folder / overlay;
  OutputErrors errors;
  write_record_files(arguments, result, errors);
  errors.rethrow_first();
  stamp.files.insert(stamp.files.end(), {map, overlay});
}

/// "relmse", "median_error" (of the pixels' relative errors) and "ssim" of a picture against a kReference
/// panel and its mean. The two halves' noise cancels in the first one; for the first two the mean luminance
/// is scaled to one half.
NamedNumbers errors_against(const fs::path& folder, const PanelStamp& reference, const Image& mean,
                            const Image& image, const Display& display) {
  VRC_CHECK(reference.files.size() >= 4, "a reference has {} files", reference.files.size());
  const Image a = read_image(folder / reference.files[2]), b = read_image(folder / reference.files[3]);
  const auto scale = static_cast<float>(kMeanLuminance / std::max(mean_luminance(mean), 1e-30));
  const Image measured = scaled(image, scale);
  const std::array half = {0.5};
  const Image error = relative_error_map(measured, scaled(mean, scale));
  return {{"relmse", two_half_relmse(measured, scaled(a, scale), scaled(b, scale))},
          {"median_error", percentiles(error, half).front()},
          {"ssim", mean_ssim(encoded(image, display), encoded(mean, display))}};
}

PanelStamp make_render(const FigureGroup& group, const FigurePanel& panel, const PanelStamps& earlier,
                       const PanelPlace& place, const std::atomic<bool>& stop) {
  RenderCommand command;
  const auto render = [&](const std::string& extra) {
    command = command_of(group, panel, extra, place);
    return run_whole(command, stop);
  };
  SceneRun run;
  if (panel.equal_time) {
    const double seconds = number_of(earlier.at(panel.equal_time->panel).numbers, "cpu_seconds");
    const auto words = [&](int number) { return fmt::format("{} {}", panel.equal_time->option, number); };
    TimedRun timed =
        run_for_time(*panel.equal_time, seconds, [&](int number) { return render(words(number)); });
    run = std::move(timed.run);
    command = command_of(group, panel, words(timed.number), place);
  } else {
    run = render("");
  }
  const Image& image = run.result.image;
  PanelStamp stamp;
  stamp.command = command.text;
  if (!panel.is_point) {
    write_pictures(panel, place, command, image, run.report, stamp);
    write_records(panel, place, command.arguments, run.result, stamp);
  }
  stamp.numbers = numbers_of(run.report, run.result);
  if (!panel.reference.empty()) {
    const PanelStamp& reference = earlier.at(panel.reference);
    const Image mean = read_image(place.folder / reference.files.front());
    const NamedNumbers errors =
        errors_against(place.folder, reference, mean, image, command.arguments.display);
    stamp.numbers.insert(stamp.numbers.end(), errors.begin(), errors.end());
    if (!panel.is_point) {
      stamp.files.push_back(panel.id + "_error.png");
      write_png(place.folder / stamp.files.back(), error_colors(image, mean));
    }
  }
  return stamp;
}

/// Everything that the panel's files depend on.
std::uint64_t key_of(const FigureGroup& group, const FigurePanel& panel, const PanelStamps& earlier,
                     std::uint64_t scene_key) {
  std::uint64_t key = hash(scene_key, panel.kind);
  for (const std::string& text : {group.scene, group.words, group.quantity, panel.words, panel.method})
    key = hash_bytes(key, text);
  if (panel.equal_time) key = hash_bytes(key, panel.equal_time->option);
  for (const std::string& other :
       {panel.reference, panel.equal_time ? panel.equal_time->panel : std::string()}) {
    if (!other.empty()) key = hash(key, earlier.at(other).key);
  }
  if (panel.equal_time) {
    // Another measurement of the time asks for another number.
    const double seconds = number_of(earlier.at(panel.equal_time->panel).numbers, "cpu_seconds");
    key = hash(key, std::bit_cast<std::uint64_t>(seconds));
  }
  return key;
}

}  // namespace

MadePanel make_panel(const FigureGroup& group, const FigurePanel& panel, std::uint64_t scene_key,
                     const PanelStamps& earlier, const PanelPlace& place, const std::atomic<bool>& stop) {
  const std::uint64_t key = key_of(group, panel, earlier, scene_key);
  if (!place.restart) {
    std::optional<PanelStamp> stamp = read_stamp(place.folder, panel.id, key);
    if (stamp && stamp->files.empty() == panel.is_point) return {std::move(*stamp), true};
  }
  remove_stamp(place.folder, panel.id);
  PanelStamp stamp;
  switch (panel.kind) {
    case PanelKind::kRender:
      stamp = make_render(group, panel, earlier, place, stop);
      break;
    case PanelKind::kReference:
      stamp = make_reference(group, panel, place, stop);
      break;
    case PanelKind::kDerivatives:
      stamp = make_derivatives(group, panel, scene_key, place, stop);
      break;
  }
  stamp.key = key;
  write_stamp(place.folder, panel.id, stamp);
  return {std::move(stamp), false};
}

}  // namespace vrc
