// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/xml_text.h"

namespace vrc {
namespace {

// Lengths in pixels of the document.
constexpr double kPlotWidth = 300, kPlotHeight = 240;
constexpr double kLeft = 64, kTop = 34, kRight = 16, kBottom = 48, kLegendHeight = 12;
constexpr double kMarker = 3.5;
constexpr double kLegendRow = 18, kLegendLetter = 6.6, kLegendGap = 34;
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73",
                                "#cc79a7", "#56b4e9", "#e69f00"};  // [OkabeIto2008]
constexpr std::size_t kShapes = 5;

std::string text(double x, double y, const char* anchor, const std::string& content, int size = 12,
                 const std::string& attributes = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" text-anchor=\"{}\"{}>{}</text>\n", x,
                     y, size, anchor, attributes, content);
}

/// In the colour of the text, paler.
std::string grid_line(double x0, double y0, double x1, double y1, double opacity) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"currentColor\" "
      "stroke-opacity=\"{}\"/>\n",
      x0, y0, x1, y1, opacity);
}

/// Disc, square, diamond, triangle or triangle upside down.
std::string marker(std::size_t shape, double x, double y) {
  const char* color = kColors[shape % kColors.size()];
  const double r = kMarker;
  switch (shape % kShapes) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, r, color);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", x - r,
                         y - r, 2 * r, 2 * r, color);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l{} {}l{} {}l{} {}z\" fill=\"{}\"/>\n", x, y - 1.4 * r,
                         1.4 * r, 1.4 * r, -1.4 * r, 1.4 * r, -1.4 * r, -1.4 * r, color);
    case 3:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l{} {}h{}z\" fill=\"{}\"/>\n", x, y - 1.3 * r, 1.3 * r,
                         2.3 * r, -2.6 * r, color);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l{} {}h{}z\" fill=\"{}\"/>\n", x, y + 1.3 * r, -1.3 * r,
                         -2.3 * r, 2.6 * r, color);
  }
}

std::string power_of_ten(int exponent) {
  return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", exponent);
}

/// Logarithmic between whole decades around the values, or linear between round numbers when a value is
/// not positive.
class Axis {
 public:
  Axis(std::span<const PlotSeries> series, int coordinate, double from, double to) : begin_(from), end_(to) {
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const PlotSeries& s : series) {
      for (const Vec2& p : s.points) {
        least = std::min(least, p[coordinate]);
        most = std::max(most, p[coordinate]);
      }
    }
    if (least > most) least = most = 1.0;
    logarithmic_ = least > 0.0;
    if (logarithmic_) {
      low_ = std::floor(std::log10(least) + 1e-9);
      high_ = std::max(low_ + 1.0, std::ceil(std::log10(most) - 1e-9));
      step_ = 1.0;
    } else {
      step_ = round_step(std::max(most - least, 1e-12 * std::max(std::abs(least), 1.0)));
      low_ = step_ * std::floor(least / step_ + 1e-9);
      high_ = std::max(low_ + step_, step_ * std::ceil(most / step_ - 1e-9));
    }
    stride_ = step_ * std::ceil(std::round((high_ - low_) / step_) / kMostLabels);
  }
  [[nodiscard]] double at(double value) const { return place(logarithmic_ ? std::log10(value) : value); }
  /// Calls body(place, opacity) for the labelled values and, of decades, what divides them.
  template <typename Body>
  void for_each_grid_line(const Body& body) const {
    for_each_step([&](double step) {
      body(place(step), 0.25);
      if (!logarithmic_ || stride_ > step_ || step + 0.5 > high_) return;
      for (int digit = 2; digit < 10; ++digit) body(place(step + std::log10(digit)), 0.08);
    });
  }
  /// Calls body(place, text).
  template <typename Body>
  void for_each_label(const Body& body) const {
    for_each_step([&](double step) {
      body(place(step), logarithmic_ ? power_of_ten(static_cast<int>(std::lround(step)))
                                     : fmt::format("{:g}", std::abs(step) < 1e-9 * step_ ? 0.0 : step));
    });
  }

 private:
  /// 1, 2 or 5 times a power of ten, four to nine of which span `range`.
  static double round_step(double range) {
    const double decade = std::pow(10.0, std::floor(std::log10(range / 4.0)));
    for (const double digit : {5.0, 2.0}) {
      if (range / 4.0 >= digit * decade) return digit * decade;
    }
    return decade;
  }
  [[nodiscard]] double place(double position) const {
    return begin_ + (end_ - begin_) * (position - low_) / (high_ - low_);
  }
  template <typename Body>
  void for_each_step(const Body& body) const {
    for (int i = 0; low_ + i * stride_ <= high_ + 0.5 * step_; ++i) body(low_ + i * stride_);
  }

  static constexpr double kMostLabels = 10.0;

  double begin_, end_;                      ///< In the document.
  double low_ = 0, high_ = 1, step_ = 1.0;  ///< Values, or their powers of ten.
  double stride_ = 1.0;                     ///< Between labels: every step, or every second, third ... one.
  bool logarithmic_ = true;
};

std::string draw_panel(const PlotPanel& panel, double left, const std::string& x_label,
                       const std::string& y_label, std::span<const std::string> names) {
  const double right = left + kPlotWidth, top = kTop, bottom = kTop + kPlotHeight;
  const Axis x(panel.series, 0, left, right), y(panel.series, 1, bottom, top);
  std::string svg = text(0.5 * (left + right), top - 14, "middle", xml_escaped(panel.title), 14);
  x.for_each_grid_line([&](double at, double opacity) { svg += grid_line(at, top, at, bottom, opacity); });
  y.for_each_grid_line([&](double at, double opacity) { svg += grid_line(left, at, right, at, opacity); });
  x.for_each_label(
      [&](double at, const std::string& label) { svg += text(at, bottom + 18, "middle", label); });
  y.for_each_label([&](double at, const std::string& label) { svg += text(left - 8, at + 4, "end", label); });
  svg += text(0.5 * (left + right), bottom + 38, "middle", xml_escaped(x_label));
  const double label_x = left - 48, label_y = 0.5 * (top + bottom);
  svg += text(label_x, label_y, "middle", xml_escaped(y_label), 12,
              fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", label_x, label_y));
  for (const PlotSeries& s : panel.series) {
    const auto shape = static_cast<std::size_t>(std::ranges::find(names, s.name) - names.begin());
    std::string path;
    for (const Vec2& p : s.points) path += fmt::format("{:.1f},{:.1f} ", x.at(p.x()), y.at(p.y()));
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n", path,
                       kColors[shape % kColors.size()]);
    for (const Vec2& p : s.points) svg += marker(shape, x.at(p.x()), y.at(p.y()));
  }
  return svg;
}

/// Shapes and names of the series in rows, the first `top` from the document's upper border; `height`
/// becomes that of all.
std::string draw_legend(std::span<const std::string> names, double width, double top, double& height) {
  std::string svg;
  double at = kLeft, y = top;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double length = kLegendLetter * static_cast<double>(names[i].size());
    if (at > kLeft && at + 10 + length > width) {
      at = kLeft;
      y += kLegendRow;
    }
    svg += marker(i, at, y - 4);
    svg += text(at + 10, y, "start", xml_escaped(names[i]));
    at += kLegendGap + length;
  }
  height = y - top + kLegendRow;
  return svg;
}

}  // namespace

std::string plot_svg(std::span<const PlotPanel> panels, const std::string& x_label,
                     const std::string& y_label, PlotPaper paper) {
  std::vector<std::string> names;
  for (const PlotPanel& panel : panels) {
    for (const PlotSeries& s : panel.series) {
      if (std::ranges::find(names, s.name) == names.end()) names.push_back(s.name);
    }
  }
  const double column = kLeft + kPlotWidth + kRight;
  const double width = column * static_cast<double>(std::max<std::size_t>(panels.size(), 1));
  const double top = kTop + kPlotHeight + kBottom + kLegendHeight;
  double legend_height = 0.0;
  const std::string legend = draw_legend(names, width, top, legend_height);
  const double height = top + legend_height;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" font-family=\"{2}\" {3} fill=\"currentColor\">\n",
      width, height, paper == PlotPaper::kWhite ? "sans-serif" : "inherit",
      paper == PlotPaper::kWhite ? "color=\"#222\"" : "aria-hidden=\"true\"");
  if (paper == PlotPaper::kWhite) svg += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  for (std::size_t i = 0; i < panels.size(); ++i)
    svg += draw_panel(panels[i], kLeft + column * static_cast<double>(i), x_label, y_label, names);
  return svg + legend + "</svg>\n";
}

}  // namespace vrc
