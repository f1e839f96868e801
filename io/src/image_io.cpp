// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/image_io.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/color.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::uint8_t, 3> kNanColor{255, 0, 255};
constexpr double kMaxValues = 4e9;  // 16 GB of floats: above, a header lies more often than not.

void write_pixels(const fs::path& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                  const void* pixels) {
  AtomicFile file(path);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(file.temporary().string());
  if (!out) throw InputError(path.string(), 0, "cannot be written: " + OIIO::geterror());
  const bool written =
      out->open(file.temporary().string(), spec) && out->write_image(type, pixels) && out->close();
  if (!written) throw InputError(path.string(), 0, "cannot be written: " + out->geterror());
  file.commit();
}

OIIO::ImageSpec make_spec(const Image& image, std::size_t channels, const OIIO::TypeDesc& type) {
  VRC_CHECK(image.width > 0 && image.height > 0 && channels > 0, "an image of {}x{} with {} channels",
            image.width, image.height, channels);
  VRC_CHECK(image.pixels.size() == image.pixel_count() * image.channels.size(), "{} values for {}x{}x{}",
            image.pixels.size(), image.width, image.height, image.channels.size());
  return {image.width, image.height, static_cast<int>(channels), type};
}

/// NaN has no brightness, so it gets a colour that shows.
std::array<std::uint8_t, 3> encode_pixel(const float* linear) {
  if (std::any_of(linear, linear + 3, [](float v) { return std::isnan(v); })) return kNanColor;
  std::array<std::uint8_t, 3> encoded{};
  for (std::size_t c = 0; c < 3; ++c) encoded[c] = quantize8(srgb_from_linear(linear[c]));
  return encoded;
}

/// Integer formats hold sRGB values; `Image` holds linear ones. Alpha is linear already.
void linearize(Image& image, int alpha_channel) {
  const std::size_t channels = image.channels.size();
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (static_cast<int>(i % channels) != alpha_channel) image.pixels[i] = linear_from_srgb(image.pixels[i]);
  }
}

}  // namespace

void write_exr(const fs::path& path, const Image& image, const ImageMetadata& metadata) {
  OIIO::ImageSpec spec = make_spec(image, image.channels.size(), OIIO::TypeDesc::FLOAT);
  spec.channelnames = image.channels;
  spec.attribute("compression", "zip");
  spec.attribute("oiio:ColorSpace", "Linear");
  // Otherwise the library stamps the time of writing, and equal pictures differ in bytes.
  spec.attribute("DateTime", "");
  for (const auto& [key, value] : metadata) spec.attribute(key, value);
  write_pixels(path, spec, OIIO::TypeDesc::FLOAT, image.pixels.data());
}

void write_png(const fs::path& path, const Image& image, const Display& display) {
  OIIO::ImageSpec spec = make_spec(image, image.channels.empty() ? 0 : 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  const Image shown = displayed(image, display);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.pixel_count() * 3);
  for (std::size_t p = 0; p < shown.pixel_count(); ++p) {
    const auto encoded = encode_pixel(shown.pixels.data() + 3 * p);
    bytes.insert(bytes.end(), encoded.begin(), encoded.end());
  }
  write_pixels(path, spec, OIIO::TypeDesc::UINT8, bytes.data());
}

Image read_image(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path.string(), 0, "no such file");
  if (!fs::is_regular_file(path, error)) throw InputError(path.string(), 0, "is not a regular file");
  const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path.string());
  if (!in) throw InputError(path.string(), 0, "cannot be read as an image: " + OIIO::geterror());
  const OIIO::ImageSpec spec = in->spec();
  if (spec.deep || spec.depth > 1 || spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) {
    throw InputError(path.string(), 0, "is a deep, volume or empty image; give a flat one");
  }
  const double values = static_cast<double>(spec.width) * spec.height * spec.nchannels;
  if (values > kMaxValues) {
    throw InputError(path.string(), 0,
                     fmt::format("claims {}x{} pixels with {} channels, which is too large", spec.width,
                                 spec.height, spec.nchannels));
  }
  Image image(spec.width, spec.height, spec.channelnames);
  if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data())) {
    throw InputError(path.string(), 0, "cannot be read whole: " + in->geterror());
  }
  if (spec.get_string_attribute("oiio:ColorSpace") == "sRGB") linearize(image, spec.alpha_channel);
  return image;
}

}  // namespace vrc
