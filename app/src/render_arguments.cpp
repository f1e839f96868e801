// SPDX-License-Identifier: GPL-3.0-or-later
#include "render_arguments.h"

#include "cli_values.h"
#include "display_arguments.h"
#include "placement/pixel_gather.h"
#include "placement/presets.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFooter = R"(
Examples:
  vrc render scenes/cornell_glossy.xml -o box.exr -o box.png
  vrc render scenes/cornell_glossy.xml --only indirect --error 0.01 --record-map records.ply -o box.exr
  vrc render bunny.ply --size 640x480 --camera-origin 0,1,4 --camera-target 0,0.5,0 -o bunny.png
The same command gives the same picture at any number of threads. Ctrl-C stops the work and writes
what there is; a second one ends the program at once.)";

constexpr const char* kRecordsFooter = R"(
Examples:
  vrc records scenes/curved_room.xml -o records.vtp -o records.csv --ellipses ellipses.ply
  vrc records scenes/half_box.xml --records 5000 --overlay half_box.png
Maps hold for every record where it is (also face, chart and u, v), its region (r1 r2, e1 e2), radiance,
gradient and Hessian, its place and half axes in the picture (px py, p1x p1y, p2x p2y, in pixels from the
upper left corner), its rays, and how its surface bends (deviation, curvature, reason; needs_sh is 1 where the
paper would use spherical harmonics, is_sh where the record does, sh_reason why). .ply opens in MeshLab, Blender and CloudCompare, .vtp in ParaView.
The overlay draws the ellipses at half their size, as they overlap: blue for Taylor records, orange for
those of spherical harmonics. The same command gives the same files at any number of threads.)";

constexpr const char* kOverlayHelp =
    "Write the picture (.png) with the records' centres and ellipses at half size drawn over it: blue for "
    "Taylor records, orange for those of spherical harmonics";

using OptionalPath = std::optional<fs::path>;

void add_output_file(CLI::App& command, const char* name, OptionalPath& target, const char* description) {
  add_value(command, name, "FILE", description, "a file name", [&target](const std::string& text) {
    target = text;
    return !text.empty();
  })->group("Output");
}

void add_output_files(CLI::App& command, const char* name, std::vector<fs::path>& target,
                      const char* description) {
  command.add_option(name, target, description)->type_name("FILE")->allow_extra_args(false)->group("Output");
}

void declare_stats(CLI::App& command, RenderArguments& arguments) {
  add_output_file(command, "--stats", arguments.stats, "Write times, counts and settings as JSON");
}

void declare_record_outputs(CLI::App& command, RenderArguments& arguments) {
  add_output_files(command, "-o,--output", arguments.record_maps,
                   "Record map to write: points as .ply, .vtp or .csv; may be repeated");
  add_output_file(command, "--ellipses", arguments.record_ellipses,
                  "Write the records' ellipses on the surface as a mesh, .ply or .vtp");
  add_output_file(command, "--overlay", arguments.record_overlay, kOverlayHelp);
  declare_stats(command, arguments);
  declare_display(command, arguments.display, "PNG files are", "Output");
}

void declare_outputs(CLI::App& command, RenderArguments& arguments) {
  command
      .add_option("-o,--output", arguments.images,
                  "Picture to write: .exr (32-bit float, all layers) or .png (8-bit sRGB); may be repeated")
      ->type_name("FILE")
      ->required()
      ->allow_extra_args(false)
      ->group("Output");
  add_output_files(command, "--record-map", arguments.record_maps,
                   "Write the cache records as points, .ply, .vtp or .csv; may be repeated");
  add_output_file(command, "--record-ellipses", arguments.record_ellipses,
                  "Write the records' ellipses on the surface as a mesh, .ply or .vtp");
  add_output_file(command, "--record-overlay", arguments.record_overlay, kOverlayHelp);
  declare_stats(command, arguments);
  add_output_file(command, "--reference", arguments.reference,
                  "Print the relMSE of R, G, B against this picture");
  declare_display(command, arguments.display, "PNG files are", "Output");
  add_value(
      command, "--camera-path", "FILE",
      "Render a frame for each line 'ox oy oz tx ty tz [ux uy uz]' of this file (origin, target, up) from "
      "one cache that grows; frame 12 of a.exr is a_0012.exr",
      "a file name",
      [&arguments](const std::string& text) {
        arguments.camera_path = text;
        return !text.empty();
      })
      ->group("Output");
  command.add_flag("--aovs", arguments.render.aovs, "Add the layers albedo, N and depth to EXR files")
      ->group("Output");
}

void declare_method(CLI::App& command, RenderOptions& render) {
  add_choice(command, "--method", render.method,
             {{"cache", Method::kCache}, {"path", Method::kPath}, {"direct", Method::kDirect}},
             "Radiance cache, path tracing, or direct light only")
      ->group("Picture");
  add_choice(command, "--only", render.only,
             {{"full", Component::kFull}, {"direct", Component::kDirect}, {"indirect", Component::kIndirect}},
             "Light that the channels R, G, B hold")
      ->group("Picture");
  add_number(
      command, "--path-rays", render.path_rays, NumberRange<int>{1 << kFewestLog2PixelRays, 1 << 20},
      "With --method path: so many indirect rays from the points of each pixel's samples, guided by those "
      "of other pixels, instead of one path from each sample",
      "one path")
      ->group("Picture");
}

void declare_picture(CLI::App& command, RenderArguments& arguments) {
  const auto group = [](CLI::Option* option) { option->group("Picture"); };
  RenderOptions& render = arguments.render;
  declare_view(command, arguments, render.crop, render.seed);
  group(add_number(command, "--spp", arguments.samples_per_pixel, NumberRange<int>{1, 1 << 20},
                   "Camera samples of a pixel", "the scene's"));
  group(add_number(command, "--light-samples", render.light_samples, NumberRange<int>{0, 4096},
                   "Direct light samples for each camera sample; 0 chooses by method"));
}

/// Options take effect in the order of their declaration, wherever they stand on the command line: this
/// one must come before all that set a part of `cache`.
CLI::Option* declare_preset(CLI::App& command, CacheOptions& cache) {
  return add_value(command, "--preset", "default|paper",
                   "What the other options of this group are when they are not given: this program's, or "
                   "the paper's (docs/decisions/010)",
                   "one of default|paper",
                   [&cache](const std::string& text) {
                     if (text == "paper") cache = paper_preset(cache);
                     return text == "default" || text == "paper";
                   })
      ->default_str("default");
}

void declare_cache(CLI::App& command, RenderArguments& arguments) {
  CacheOptions& cache = arguments.render.cache;
  const auto group = [](CLI::Option* option) {
    option->group("Radiance cache");
    return option;
  };
  group(declare_preset(command, cache));
  CLI::Option* error = group(add_number(command, "--error", cache.error, NumberRange<double>{1e-5, 10.0},
                                        "Accepted relative error of the picture; smaller is slower"));
  CLI::Option* time =
      group(add_number(command, "--time", arguments.seconds, NumberRange<double>{0.01, 1e7},
                       "Seconds that the command may take before it writes files, instead of --error; the "
                       "picture then depends on the clock",
                       "by --error"));
  time->excludes(error);
  group(add_choice(command, "--error-of", cache.error_of_picture, {{"picture", true}, {"records", false}},
                   "What --error is of: the picture, as far as its records tell before it is shaded, or "
                   "what records are placed for, as with --overture off"));
  group(add_number(command, "--records", cache.records, NumberRange<int>{1, 100'000'000},
                   "Make about this many records (within 5 %) instead of following --error", "by --error"))
      ->excludes(error)
      ->excludes(time);
  group(add_number(command, "--gather-rays", cache.gather_rays, NumberRange<int>{1, 1 << 20},
                   "Rays of a record on average, each having a power of two, at least 1024", "by sharpness"));
  group(add_number(command, "--taylor-order", cache.taylor_order, NumberRange<int>{0, 2},
                   "Order of the interpolation between records"));
  group(command.add_flag_callback(
      "--no-glossy-glossy", [&cache] { cache.glossy_glossy = false; },
      "Leave out the derivative of light reflected by glossy surfaces"));
  group(add_choice(command, "--occlusion", cache.occlusion_aware, {{"on", true}, {"off", false}},
                   "Derivatives know how silhouettes move over what is behind them"));
  CLI::Option* flat = group(command.add_flag_callback(
      "--flat-derivatives", [&cache] { cache.total_derivative = cache.joint_weight = false; },
      "Derivatives and weights that know neither how surfaces bend nor how GGX masks, as in the paper"));
  group(command.add_flag_callback(
            "--total-derivatives", [&cache] { cache.total_derivative = cache.joint_weight = true; },
            "Those that know both; the default without --preset paper"))
      ->excludes(flat);
  group(add_choice(
      command, "--guided", cache.guided, {{"on", true}, {"off", false}},
      "Gather rays go where those of nearby records found light, not by the material alone, and the points "
      "of the lights at glossy hits are chosen from several"));
  group(add_choice(command, "--sampler", cache.sampler,
                   {{"image", Sampler::kImage}, {"surface", Sampler::kSurface}},
                   "Place records by the picture's pixels, or around each other over the surfaces"));
  CLI::Option* strategy = group(
      add_choice(command, "--strategy", cache.strategy,
                 {{"view-dependent", Strategy::kViewDependent},
                  {"view-independent", Strategy::kViewIndependent},
                  {"view-independent-outgoing", Strategy::kViewIndependentOutgoing}},
                 "Record radii by the radiance towards the camera, or by the incident or outgoing radiance "
                 "of all directions"));
  CLI::Option* representation = group(
      add_choice(command, "--representation", cache.representation,
                 {{"hybrid", Representation::kHybrid},
                  {"analytic", Representation::kAnalytic},
                  {"sh", Representation::kHarmonics}},
                 "What records hold: radiance with derivatives, incident radiance in spherical harmonics, "
                 "or the first, and the second where --sh-rule says so"));
  group(add_choice(
      command, "--sh-rule", cache.harmonics_rule,
      {{"auto", HarmonicsRule::kAuto}, {"paper", HarmonicsRule::kPaper}},
      fmt::format(
          "Spherical harmonics of a hybrid cache: where they were measured to be better (few --records; "
          "edges narrower than a pixel, with --records or --hard-pixels off), or wherever normals turn "
          "by more than --max-normal-deviation or, without, {}",
          kLargestNormalDeviation)));
  group(add_choice(command, "--sh-rays", cache.harmonics_rays,
                   {{"auto", HarmonicsRays::kAuto},
                    {"uniform", HarmonicsRays::kUniform},
                    {"cosine", HarmonicsRays::kCosine},
                    {"brdf", HarmonicsRays::kBrdf}},
                   "Distribution of the rays of spherical harmonics; auto is by the BRDF for one camera, by "
                   "the cosine for all"));
  group(add_number(command, "--sh-order", cache.harmonics_order, NumberRange<int>{1, sh::kMaxFrameOrder},
                   "Order of spherical harmonics", "by the lobes of each material, 8 to 24"));
  CLI::Option* placement = group(add_choice(
      command, "--placement", cache.metric,
      {{"hessian", PlacementMetric::kHessian},
       {"uniform", PlacementMetric::kUniform},
       {"split-sphere", PlacementMetric::kSplitSphere}},
      "Record radii by the radiance Hessian, one radius everywhere, or a share of the mean distance"));
  group(
      add_number(command, "--max-normal-deviation", cache.max_normal_deviation,
                 NumberRange<double>{1e-3, 1.5}, "Largest angle of normals across a record, in radians",
                 fmt::format("by the lobes of each material and the error, {} at most, wider where no record "
                             "reaches",
                             kLargestNormalDeviation)));
  group(add_number(command, "--gradient-share", cache.gradient_share, NumberRange<double>{0.0, 100.0},
                   "Of the squared gradient over the radiance, added to the Hessian that radii follow"));
  group(add_number(command, "--dark-share", cache.dark_share, NumberRange<double>{0.0, 100.0},
                   "Of the mean radiance, which errors in the dark are relative to"));
  group(add_number(command, "--blend-support", cache.blend_support, NumberRange<double>{1.0, 3.0},
                   "Records are blended up to this multiple of their radii"));
  group(add_choice(command, "--supersample-edges", cache.supersample_edges, {{"on", true}, {"off", false}},
                   "Up to eight times the samples (128 at most) where a pixel's see different surfaces"));
  group(
      add_choice(command, "--hard-pixels", cache.hard_pixels, {{"on", true}, {"off", false}},
                 "Gather again at pixels whose records disagree or that see an edge, and measure the error"));
  group(add_choice(command, "--joint-fit", cache.joint_fit, {{"on", true}, {"off", false}},
                   "Refine records by their neighbours' values"));
  group(add_choice(command, "--overture", cache.overture, {{"on", true}, {"off", false}},
                   "Make all records before the picture is shaded; off: while it is, line by line, so that a "
                   "pixel blends only those that it or earlier pixels asked for"));
  CLI::Option* baseline = group(add_choice(command, "--baseline", arguments.baseline,
                                           {{"none", Baseline::kNone},
                                            {"krivanek", Baseline::kKrivanek},
                                            {"ward", Baseline::kWard},
                                            {"schwarzhaupt", Baseline::kSchwarzhaupt}},
                                           "Work like an earlier method: radiance caching in spherical "
                                           "harmonics, or irradiance caching (diffuse scenes only)"));
  for (CLI::Option* other : {strategy, representation, placement}) baseline->excludes(other);
}

/// On the options as they were completed: presets and baselines set what does not go together.
void check_overture(const RenderOptions& options) {
  const CacheOptions& cache = options.cache;
  if (cache.overture) return;
  if (cache.joint_fit || cache.hard_pixels || cache.sampler == Sampler::kSurface || options.seconds > 0.0) {
    throw InputError(
        "--overture off shades while records are made: give --joint-fit off and --hard-pixels off (or "
        "--preset "
        "paper), and neither --sampler surface nor --time");
  }
}

}  // namespace

void declare_render_options(CLI::App& command, RenderArguments& arguments) {
  declare_scene(command, arguments);
  declare_outputs(command, arguments);
  declare_method(command, arguments.render);
  declare_picture(command, arguments);
  declare_cache(command, arguments);
  declare_run(command, arguments);
  command.footer(kFooter);
}

void declare_records_options(CLI::App& command, RenderArguments& arguments) {
  declare_scene(command, arguments);
  declare_record_outputs(command, arguments);
  declare_picture(command, arguments);
  declare_cache(command, arguments);
  declare_run(command, arguments);
  command.footer(kRecordsFooter);
}

RenderOptions render_options_for(const RenderArguments& arguments, const SceneDescription& scene) {
  RenderOptions options = arguments.render;
  // Only incident radiance serves the cameras of other frames.
  if (arguments.camera_path) options.cache.representation = Representation::kHarmonics;
  options.cache = baseline_options(arguments.baseline, options.cache);
  options.samples_per_pixel = arguments.samples_per_pixel.value_or(scene.samples_per_pixel);
  options.seconds = arguments.seconds;
  options.cache.classify_sites =
      arguments.stats || arguments.record_ellipses || !arguments.record_maps.empty();
  options.bounces = bounces_for(arguments, scene);
  check_overture(options);
  check_crop(options.crop, scene.camera);
  return options;
}

}  // namespace vrc
