// SPDX-License-Identifier: GPL-3.0-or-later
// Means over blocks of pixels and seeds agree with path tracing's within their scatter: no error is shared by
// all pictures. bench/pooled_means.cpp does the same at length.
#include <gtest/gtest.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "core/image_error.h"
#include "render_support.h"

namespace vrc {
namespace {

constexpr int kSeeds = 6, kSize = 96, kBlock = 24;
constexpr double kSignificance = 1e-3;  // of all blocks of a scene together
constexpr double kError = 0.02;

/// R, G and B of the means over blocks, in a row.
std::vector<double> means_of(const Image& image) {
  const Image blocks = block_means(image, kBlock);
  std::vector<double> values;
  for (int y = 0; y < blocks.height; ++y) {
    for (int x = 0; x < blocks.width; ++x)
      values.insert(values.end(), blocks.pixel(x, y), blocks.pixel(x, y) + 3);
  }
  return values;
}

/// The largest |t| that one of `tests` tests exceeds with probability kSignificance, by Sidak's correction.
double bound_of(std::size_t tests) {
  const double each = 1.0 - std::pow(1.0 - kSignificance, 1.0 / static_cast<double>(tests));
  return quantile(complement(boost::math::students_t(kSeeds - 1), 0.5 * each));
}

TEST(PooledMeans, AgreeWithPathTracing) {
  for (const char* name : {"half_box.xml", "cornell_glossy.xml"}) {
    const Scene scene = test::load_scene(name, kSize, kSize);
    const test::IndirectReference reference(scene, 128, 1024);
    const std::array halves = {means_of(reference.halves[0]), means_of(reference.halves[1])};
    std::vector<std::vector<double>> pictures;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      RenderOptions options =
          test::options_of(Method::kCache, 16, static_cast<std::uint64_t>(seed), Component::kIndirect);
      options.cache.error = kError;
      Image image = render(scene, options).image;
      for (float& v : image.pixels) v *= reference.scale;
      pictures.push_back(means_of(image));
    }
    const std::size_t tests = halves[0].size();
    double noise = 0.0;  // of the references' mean, over all blocks
    for (std::size_t i = 0; i < tests; ++i)
      noise += 0.25 * std::pow(halves[0][i] - halves[1][i], 2) / static_cast<double>(tests);
    double bias = 0.0;
    for (std::size_t i = 0; i < tests; ++i) {
      double mean = 0.0, variance = 0.0;
      for (const auto& picture : pictures) mean += picture[i] / kSeeds;
      for (const auto& picture : pictures)
        variance += std::pow(picture[i] - mean, 2) / (kSeeds * (kSeeds - 1));
      const double expected = 0.5 * (halves[0][i] + halves[1][i]), difference = mean - expected;
      EXPECT_LT(std::abs(difference) / std::sqrt(variance + noise), bound_of(tests))
          << name << ", value " << i;
      bias +=
          difference * difference / (expected * expected + kRelativeErrorOffset) / static_cast<double>(tests);
    }
    EXPECT_LT(std::sqrt(bias), 0.25 * kError) << name;
  }
}

}  // namespace
}  // namespace vrc
