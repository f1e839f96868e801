// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "shading/false_color.h"
#include "tiny_font.h"

namespace vrc {
namespace {

// In font pixels, from the top of the strip.
constexpr int kBarTop = 4, kBarBottom = 13, kTextTop = 17, kStripHeight = 28, kMargin = 6;
constexpr int kMinimumWidth = 160, kMinimumHeight = 120;

int font_scale(int bar_height) { return bar_height / kStripHeight; }

int text_width(const std::string& text, int scale) {
  return scale * (kGlyphAdvance * static_cast<int>(text.size()) - (kGlyphAdvance - kGlyphWidth));
}

void set_pixel(Image& image, int x, int y, const Rgb& color) {
  for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = color[c];
}

void draw_text(Image& image, int left, int top, int scale, const std::string& text) {
  for (int y = 0; y < scale * kGlyphHeight; ++y) {
    for (int x = 0; x < text_width(text, scale); ++x) {
      const int column = x / scale;
      const char character = text[static_cast<std::size_t>(column / kGlyphAdvance)];
      if (!glyph_has_ink(character, column % kGlyphAdvance, y / scale)) continue;
      if (left + x < image.width) set_pixel(image, left + x, top + y, Rgb::Zero());
    }
  }
}

void draw_labels(Image& image, int top, int scale, const ColorBar& bar) {
  const std::string low = fmt::format("{:.3g}", bar.low), high = fmt::format("{:.3g}", bar.high);
  const int left = kMargin * scale, right = image.width - kMargin * scale;
  draw_text(image, left, top, scale, low);
  draw_text(image, right - text_width(high, scale), top, scale, high);
  const int title_left = (image.width - text_width(bar.title, scale)) / 2;
  const int gap = 2 * kGlyphAdvance * scale;
  const bool fits = title_left >= left + text_width(low, scale) + gap &&
                    title_left + text_width(bar.title, scale) + gap <= right - text_width(high, scale);
  if (fits) draw_text(image, title_left, top, scale, bar.title);
}

}  // namespace

int color_bar_height(int width, int height) {
  if (width < kMinimumWidth || height < kMinimumHeight) return 0;
  return kStripHeight * std::max(1, std::min(width, height) / 300);
}

Image with_color_bar(const Image& picture, const ColorBar& bar, int bar_height) {
  if (bar_height == 0) return picture;
  const int scale = font_scale(bar_height);
  Image image(picture.width, picture.height + bar_height, picture.channels);
  std::fill(image.pixels.begin(), image.pixels.end(), 1.0f);
  std::copy(picture.pixels.begin(), picture.pixels.end(), image.pixels.begin());
  const int left = kMargin * scale, right = image.width - kMargin * scale;
  for (int y = kBarTop * scale; y < kBarBottom * scale; ++y) {
    for (int x = left; x < right; ++x) {
      set_pixel(image, x, picture.height + y, bar.color((x - left) / std::max(1.0, right - left - 1.0)));
    }
  }
  draw_labels(image, picture.height + kTextTop * scale, scale, bar);
  return image;
}

}  // namespace vrc
