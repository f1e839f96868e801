// SPDX-License-Identifier: GPL-3.0-or-later
// Are pictures of the radiance cache right on average? Means over blocks of pixels, of several seeds, are
// tested against references by path tracing: Student's t for each block and channel, with Sidak's correction
// for their number. Errors that all seeds share show here, however small they are beside those of one
// picture.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdio>

#include "bench_support.h"
#include "core/image_error.h"

namespace vrc::bench {
namespace {

constexpr double kSignificance = 0.01;  // of the test of all blocks together

struct Settings : PictureSettings {
  std::vector<double> errors = {0.05, 0.02, 0.01};
  int block = 32;  ///< Pixels of a block's side.

  Settings() {
    scenes = {VRC_SOURCE_DIR "/scenes/half_box.xml", VRC_SOURCE_DIR "/scenes/cornell_glossy.xml",
              VRC_SOURCE_DIR "/scenes/cornell_ggx.xml", VRC_SOURCE_DIR "/scenes/curved_room.xml"};
    width = height = 256;
    repeats = 8;
  }
};

struct Pooled {
  std::vector<double> mean, variance;  ///< Of the mean.
};

Pooled pool(const std::vector<Image>& blocks) {
  const std::size_t values = blocks.front().pixels.size();
  const auto n = static_cast<double>(blocks.size());
  Pooled result{std::vector<double>(values), std::vector<double>(values)};
  for (std::size_t i = 0; i < values; ++i) {
    double sum = 0.0, squares = 0.0;
    for (const Image& image : blocks) sum += static_cast<double>(image.pixels[i]);
    result.mean[i] = sum / n;
    for (const Image& image : blocks)
      squares += std::pow(static_cast<double>(image.pixels[i]) - result.mean[i], 2);
    result.variance[i] = squares / ((n - 1.0) * n);
  }
  return result;
}

/// The largest |t| that one of `tests` independent tests exceeds with probability kSignificance.
double sidak_bound(std::size_t tests, double degrees) {
  const double each = 1.0 - std::pow(1.0 - kSignificance, 1.0 / static_cast<double>(tests));
  return boost::math::quantile(complement(boost::math::students_t(degrees), 0.5 * each));
}

void test_scene(const std::string& file, const Settings& settings) {
  const SceneDescription description = read_scene_for(file, settings);
  const Scene scene(description);
  const References references = make_references(scene, description, file, settings);
  const Pooled expected = pool(
      {block_means(references.images[0], settings.block), block_means(references.images[1], settings.block)});
  const std::size_t tests = expected.mean.size();
  const double degrees = settings.repeats - 1.0;
  const double bound = sidak_bound(tests, degrees);
  double noise = 0.0;  // of the references, over all blocks: two give a poor deviation of one
  for (const double v : expected.variance) noise += v / static_cast<double>(tests);
  for (const double error : settings.errors) {
    std::vector<Image> blocks;
    double relmse = 0.0;
    for (int i = 0; i < settings.repeats; ++i) {
      RenderOptions options =
          indirect_light(Method::kCache, settings.samples_per_pixel, static_cast<std::uint64_t>(i + 1));
      options.cache.error = error;
      const Image image = render(scene, options).image;
      relmse += references.error_of(image) / settings.repeats;
      blocks.push_back(block_means(scaled(rgb_of(image), references.scale), settings.block));
    }
    const Pooled measured = pool(blocks);
    double largest = 0.0, squares = 0.0, relative_bias = 0.0;
    std::size_t outside = 0;
    for (std::size_t i = 0; i < tests; ++i) {
      const double difference = measured.mean[i] - expected.mean[i];
      const double t = difference / std::sqrt(measured.variance[i] + noise);
      outside += std::abs(t) > bound;
      largest = std::max(largest, std::abs(t));
      squares += t * t / static_cast<double>(tests);
      relative_bias += difference * difference / (std::pow(expected.mean[i], 2) + kRelativeErrorOffset) /
                       static_cast<double>(tests);
    }
    fmt::print("{:24} {:>6g} {:>10.2e} {:>8.2f} {:>8.2f} {:>8.2f} {:>6}/{} {:>10.2e}\n",
               std::filesystem::path(file).stem().string(), error, relmse, std::sqrt(squares), largest, bound,
               outside, tests, std::sqrt(relative_bias));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace vrc::bench

int main(int argc, char** argv) {
  using namespace vrc;
  using namespace vrc::bench;
  Settings settings;
  CLI::App app("Tests means of pictures over blocks of pixels and seeds against path tracing");
  declare_picture_options(app, settings);
  app.add_option("--error", settings.errors, "Error thresholds of the cache")->check(CLI::PositiveNumber);
  app.add_option("--block", settings.block, "Side of a block in pixels")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  return run_reported("bench_pooled_means", settings, [&] {
    if (settings.repeats < 2)
      throw InputError("--repeats", 0, "must be at least 2: deviations come from them");
    fmt::print("{:24} {:>6} {:>10} {:>8} {:>8} {:>8} {:>10} {:>10}\n", "scene", "error", "relMSE", "rms t",
               "max |t|", "bound", "outside", "rel. bias");
    for (const std::string& scene : settings.scenes) test_scene(scene, settings);
  });
}
