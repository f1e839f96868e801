// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture_file.h"

#include "app/version.h"
#include "io/image_io.h"

namespace vrc {
namespace {

/// Where the picture comes from. The pixels do not depend on threads or time; this header may.
ImageMetadata metadata_of(const RunReport& report) {
  ImageMetadata metadata{
      {"vrc:version", std::string(kVersion)},
      {"vrc:scene", report.scene},
      {"vrc:command_line", report.command_line},
      {"vrc:seconds", fmt::format("{:.3f}", report.render_seconds)},
      {"vrc:method", std::string(name_of(report.options.method))},
      {"vrc:only", std::string(name_of(report.options.only))},
      {"vrc:bounces", std::to_string(report.options.bounces)},
      {"vrc:spp", std::to_string(report.options.samples_per_pixel)},
      {"vrc:seed", std::to_string(report.options.seed)},
  };
  if (report.options.method == Method::kCache) {
    if (report.stats.error > 0.0) metadata["vrc:error"] = fmt::format("{}", report.stats.error);
    if (report.stats.records_error > 0.0)
      metadata["vrc:records_error"] = fmt::format("{}", report.stats.records_error);
    metadata["vrc:records"] = std::to_string(report.stats.records);
  }
  if (report.stats.unfinished) metadata["vrc:unfinished"] = "true";
  return metadata;
}

}  // namespace

void write_picture(const std::filesystem::path& path, const Image& image, const Display& display,
                   const RunReport& report) {
  if (path.extension() == ".png" || path.extension() == ".PNG") {
    write_png(path, image, display);
  } else {
    write_exr(path, image, metadata_of(report));
  }
}

}  // namespace vrc
