// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/command_line.h"
#include "cli_values.h"
#include "commands.h"
#include "core/image_error.h"
#include "core/image_structure.h"
#include "display_arguments.h"
#include "error_colors.h"
#include "io/color.h"
#include "io/image_io.h"
#include "shading/false_color.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(
relMSE is the mean over pixels and channels of (A - B)^2 / (B^2 + 0.01). With --second-half it is that of
(A - R1)(A - R2) / (R^2 + 0.01), R = (R1 + R2) / 2: two independent references, whose noise cancels.
SSIM is the mean structural similarity of the pictures as a screen shows them (--exposure, --tonemap); percentiles
are those of the pixels' relative errors, the root of the mean over R, G, B.
The heat map runs from dark violet (relative error 0.001 and below) to yellow (1 and above) in steps of
equal factors; pixels that are not finite are magenta. --side-by-side shows A, B and the heat map.

Examples:
  vrc compare picture.exr reference.exr --heatmap error.png --side-by-side both.png --tonemap aces
  vrc compare picture.exr half1.exr --second-half half2.exr --layer indirect --json)";

struct CompareArguments {
  fs::path image, reference;
  std::optional<fs::path> second_half, heatmap, side_by_side;
  Display display;  // of SSIM and side by side
  std::string layer;
  int block = 1;
  bool json = false;
};

/// The image and its reference; with two halves of the reference, their mean stands for it.
struct ImageSet {
  Image image, reference;
  std::optional<Image> first_half, second_half;
};

/// Of the pixels' relative errors.
constexpr std::array kPercentiles = {0.5, 0.9, 0.95, 0.99, 1.0};

struct CompareReport {
  ImageError pixels;
  double ssim = 1.0;
  std::vector<double> percentiles;
  std::optional<double> two_half;
  std::optional<ImageError> blocks;
  std::optional<double> two_half_blocks;
};

/// R, G, B of the layer alone; says which file lacks them.
Image read_rgb(const fs::path& path, const std::string& layer) {
  const Image whole = read_image(path);
  try {
    return mean_rgb(whole, whole, layer);
  } catch (const InputError& error) {
    throw InputError(path.string(), 0, error.what());
  }
}

ImageSet read_images(const CompareArguments& arguments) {
  ImageSet set{
      read_rgb(arguments.image, arguments.layer), read_rgb(arguments.reference, arguments.layer), {}, {}};
  if (!arguments.second_half) return set;
  set.first_half = std::move(set.reference);
  set.second_half = read_rgb(*arguments.second_half, arguments.layer);
  set.reference = mean_rgb(*set.first_half, *set.second_half);
  return set;
}

ImageSet blocks_of(const ImageSet& set, int size) {
  ImageSet blocks{block_means(set.image, size), block_means(set.reference, size), {}, {}};
  if (set.first_half) blocks.first_half = block_means(*set.first_half, size);
  if (set.second_half) blocks.second_half = block_means(*set.second_half, size);
  return blocks;
}

std::optional<double> two_half_error(const ImageSet& set) {
  if (!set.first_half) return std::nullopt;
  return two_half_relmse(set.image, *set.first_half, *set.second_half);
}

CompareReport compare(const ImageSet& set, int block, const Display& display) {
  CompareReport report;
  report.pixels = compare_rgb(set.image, set.reference);
  report.ssim = mean_ssim(encoded(set.image, display), encoded(set.reference, display));
  report.percentiles = percentiles(relative_error_map(set.image, set.reference), kPercentiles);
  report.two_half = two_half_error(set);
  if (block > 1) {
    const ImageSet blocks = blocks_of(set, block);
    report.blocks = compare_rgb(blocks.image, blocks.reference);
    report.two_half_blocks = two_half_error(blocks);
  }
  return report;
}

/// A, B and the heat map, and below them what its colours mean.
Image side_by_side(const ImageSet& set, const Display& display) {
  const std::array panels = {displayed(set.image, display), displayed(set.reference, display),
                             error_colors(set.image, set.reference)};
  const int width = set.image.width, height = set.image.height;
  Image joined(3 * width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y) {
    for (int panel = 0; panel < 3; ++panel) {
      const float* row = panels[static_cast<std::size_t>(panel)].pixel(0, y);
      std::copy_n(row, 3 * width, joined.pixel(panel * width, y));
    }
  }
  const ColorBar bar = {"relative error, log10", -3.0, 0.0, [](double t) { return map_color(t); }};
  return with_color_bar(joined, bar, color_bar_height(3 * width, height));
}

std::string as_json(const CompareReport& report, int block) {
  nlohmann::ordered_json json{
      {"mse", report.pixels.mse},
      {"rmse", report.pixels.rmse},
      {"relmse", report.pixels.relmse},
      {"mean_ratio", report.pixels.mean_ratio},
      {"max_abs", report.pixels.max_abs},
      {"non_finite", report.pixels.non_finite},
      {"ssim", report.ssim},
  };
  for (std::size_t i = 0; i < kPercentiles.size(); ++i)
    json["relative_error_percentiles"][fmt::format("{:g}", 100.0 * kPercentiles[i])] = report.percentiles[i];
  if (report.two_half) json["two_half_relmse"] = *report.two_half;
  if (report.blocks) {
    json["block"] = block;
    json["block_relmse"] = report.blocks->relmse;
  }
  if (report.two_half_blocks) json["block_two_half_relmse"] = *report.two_half_blocks;
  return json.dump(2) + "\n";
}

std::string as_text(const CompareReport& report, int block) {
  std::string text;
  const auto line = [&text](const std::string& name, double value) {
    text += fmt::format("{:<24}{:.6g}\n", name, value);
  };
  line("MSE", report.pixels.mse);
  line("RMSE", report.pixels.rmse);
  line("relMSE", report.pixels.relmse);
  if (report.two_half) line("relMSE, two halves", *report.two_half);
  if (report.blocks) line(fmt::format("relMSE, {0}x{0} blocks", block), report.blocks->relmse);
  if (report.two_half_blocks) line("  two halves", *report.two_half_blocks);
  line("mean ratio", report.pixels.mean_ratio);
  line("max abs", report.pixels.max_abs);
  line("SSIM", report.ssim);
  for (std::size_t i = 0; i < kPercentiles.size(); ++i)
    line(fmt::format("relative error, {:g} %", 100.0 * kPercentiles[i]), report.percentiles[i]);
  line("not finite", static_cast<double>(report.pixels.non_finite));
  return text;
}

int run_compare(const CompareArguments& arguments) {
  for (const auto& path : {arguments.heatmap, arguments.side_by_side}) {
    if (path && path->extension() != ".png")
      throw InputError(path->string(), 0, "heat maps are written as .png; choose this extension");
  }
  const ImageSet set = read_images(arguments);
  const CompareReport report = compare(set, arguments.block, arguments.display);
  if (arguments.heatmap) write_png(*arguments.heatmap, error_colors(set.image, set.reference));
  if (arguments.side_by_side) write_png(*arguments.side_by_side, side_by_side(set, arguments.display));
  std::cout << (arguments.json ? as_json(report, arguments.block) : as_text(report, arguments.block))
            << std::flush;
  return report.pixels.non_finite > 0 ? kExitFailure : kExitDone;
}

void declare_options(CLI::App& command, CompareArguments& arguments) {
  command.add_option("image", arguments.image, "Picture to judge")->type_name("A")->required();
  command.add_option("reference", arguments.reference, "Reference, or its first half")
      ->type_name("B")
      ->required();
  const auto add_file = [&](const char* name, std::optional<fs::path>& target, const char* description) {
    add_value(command, name, "FILE", description, "a file name", [&target](const std::string& text) {
      target = text;
      return !text.empty();
    });
  };
  add_file("--second-half", arguments.second_half, "Second half of the reference, of independent noise");
  add_file("--heatmap", arguments.heatmap, "Write the relative error of each pixel as a PNG");
  add_file("--side-by-side", arguments.side_by_side, "Write both pictures and the heat map as a PNG");
  declare_display(command, arguments.display, "pictures are", "");
  command.add_option("--layer", arguments.layer, "Compare NAME.R, NAME.G, NAME.B instead of R, G, B")
      ->type_name("NAME");
  add_number(command, "--block", arguments.block, NumberRange<int>{1, 16384},
             "Also give the relMSE of means over N x N pixels");
  command.add_flag("--json", arguments.json, "Print JSON");
  command.footer(kFooter);
}

}  // namespace

CommandAction add_compare_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("compare", "Measure the difference of two pictures");
  const auto arguments = std::make_shared<CompareArguments>();
  declare_options(*command, *arguments);
  return [arguments] { return run_compare(*arguments); };
}

}  // namespace vrc
