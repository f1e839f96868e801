// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_derivatives.h"

#include "derivatives_run.h"
#include "io/image_io.h"
#include "panel_command.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

/// Stem of the files of the run that all panels with the same words share.
std::string stem_of(const FigureGroup& group, const FigurePanel& panel) {
  return fmt::format("derivatives_{:08x}",
                     hash_bytes(0, group.scene + " " + group.words + " " + panel.words) & 0xffffffffu);
}

std::string number_name(std::string_view method, std::string_view quantity) {
  return fmt::format("{} {}", method, quantity);
}

NamedNumbers numbers_of(const DerivativesRun& run) {
  NamedNumbers numbers;
  for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
    const auto method = static_cast<DerivativeMethod>(m);
    numbers.emplace_back(number_name(name_of(method), "gradient"),
                         gradient_error(run.images, method).relative_rms);
    numbers.emplace_back(number_name(name_of(method), "hessian"),
                         hessian_error(run.images, method).relative_rms);
    numbers.emplace_back(number_name(name_of(method), "cpu_seconds"), run.images.cpu_seconds[m]);
  }
  numbers.emplace_back("gather_rays", std::exp2(run.report.options.log2_rays));
  numbers.emplace_back("scale gradient", run.report.gradient_scale);
  numbers.emplace_back("scale hessian", run.report.hessian_scale);
  return numbers;
}

PanelStamp make_run(const FigureGroup& group, const FigurePanel& panel, const std::string& stem,
                    const PanelPlace& place, const std::atomic<bool>& stop) {
  const auto command =
      panel_command("derivatives", declare_derivatives_options, group, panel.words, stem, place);
  PanelStamp stamp;
  stamp.command = command.text;
  stamp.numbers = numbers_of(run_derivatives(command.arguments, command.text, stop));
  for (std::size_t m = 0; m < kDerivativeMethods; ++m) {
    for (const char* quantity : {"gradient", "hessian"}) {
      stamp.files.push_back(
          derivative_picture_path(stem, name_of(static_cast<DerivativeMethod>(m)), quantity, ".exr"));
    }
  }
  return stamp;
}

/// Makes the run or finds it made.
PanelStamp run_of(const FigureGroup& group, const FigurePanel& panel, std::uint64_t scene_key,
                  const PanelPlace& place, const std::atomic<bool>& stop) {
  const std::string stem = stem_of(group, panel), id = stem + "_run";
  const std::uint64_t key = hash_bytes(scene_key, group.words + " " + panel.words);
  if (!place.restart) {
    if (std::optional<PanelStamp> stamp = read_stamp(place.folder, id, key)) return *stamp;
  }
  remove_stamp(place.folder, id);
  PanelStamp stamp = make_run(group, panel, stem, place, stop);
  stamp.key = key;
  write_stamp(place.folder, id, stamp);
  return stamp;
}

Image signed_image(const fs::path& prefix, const std::string& method, const std::string& quantity) {
  const auto read = [&](std::string_view name) {
    return read_image(derivative_picture_path(prefix.string(), name, quantity, ".exr"));
  };
  if (method != "difference") return read(method);
  Image difference = read("analytic");
  const Image other = read("no-glossy-glossy");
  for (std::size_t i = 0; i < other.pixels.size(); ++i) difference.pixels[i] -= other.pixels[i];
  return difference;
}

/// The derivatives of size `scale` have full colours.
void write_colors(const FigureGroup& group, const FigurePanel& panel, double scale, const PanelPlace& place,
                  PanelStamp& stamp) {
  const Image colors =
      signed_colors(signed_image(place.folder / stem_of(group, panel), panel.method, group.quantity), scale);
  stamp.files = {panel.id + ".exr", panel.id + ".png"};
  write_exr(place.folder / stamp.files[0], colors, {{"vrc:command_line", stamp.command}});
  write_png(place.folder / stamp.files[1], colors);
}

}  // namespace

PanelStamp make_derivatives(const FigureGroup& group, const FigurePanel& panel, std::uint64_t scene_key,
                            const PanelPlace& place, const std::atomic<bool>& stop) {
  const PanelStamp run = run_of(group, panel, scene_key, place, stop);
  PanelStamp stamp;
  stamp.command = run.command;
  if (!panel.is_point)
    write_colors(group, panel, number_of(run.numbers, "scale " + group.quantity), place, stamp);
  if (panel.method != "difference") {
    stamp.numbers = {{"gather_rays", number_of(run.numbers, "gather_rays")},
                     {"relative_rms", number_of(run.numbers, number_name(panel.method, group.quantity))},
                     {"cpu_seconds", number_of(run.numbers, number_name(panel.method, "cpu_seconds"))}};
  }
  return stamp;
}

}  // namespace vrc
