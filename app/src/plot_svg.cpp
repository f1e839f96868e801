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
constexpr double kLeft = 64, kTop = 34, kRight = 16, kBottom = 48, kLegendHeight = 30;
constexpr double kMarker = 3.5;
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7"};  // [OkabeIto2008]

std::string text(double x, double y, const char* anchor, const std::string& content, int size = 12,
                 const std::string& attributes = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" text-anchor=\"{}\"{}>{}</text>\n", x,
                     y, size, anchor, attributes, content);
}

std::string line(double x0, double y0, double x1, double y1, const char* stroke, double width) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"{}\"/>\n",
      x0, y0, x1, y1, stroke, width);
}

/// Disc, square, diamond or triangle.
std::string marker(std::size_t shape, double x, double y) {
  const char* color = kColors[shape % kColors.size()];
  const double r = kMarker;
  switch (shape % kColors.size()) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, r, color);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", x - r,
                         y - r, 2 * r, 2 * r, color);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l{} {}l{} {}l{} {}z\" fill=\"{}\"/>\n", x, y - 1.4 * r,
                         1.4 * r, 1.4 * r, -1.4 * r, 1.4 * r, -1.4 * r, -1.4 * r, color);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l{} {}h{}z\" fill=\"{}\"/>\n", x, y - 1.3 * r, 1.3 * r,
                         2.3 * r, -2.6 * r, color);
  }
}

/// Whole decades around the values of an axis.
struct LogAxis {
  int low = 0, high = 1;          ///< Powers of ten.
  double begin = 0.0, end = 1.0;  ///< In the document.

  LogAxis(std::span<const PlotSeries> series, int coordinate, double from, double to) : begin(from), end(to) {
    double least = HUGE_VAL, most = 0.0;
    for (const PlotSeries& s : series) {
      for (const Vec2& p : s.points) {
        least = std::min(least, p[coordinate]);
        most = std::max(most, p[coordinate]);
      }
    }
    if (most == 0.0) return;
    low = static_cast<int>(std::floor(std::log10(least) + 1e-9));
    high = std::max(low + 1, static_cast<int>(std::ceil(std::log10(most) - 1e-9)));
  }
  [[nodiscard]] double at(double value) const {
    return begin + (end - begin) * (std::log10(value) - low) / (high - low);
  }
  /// Calls body(place, color) for the decades and what divides them.
  template <typename Body>
  void for_each_grid_line(const Body& body) const {
    for (int decade = low; decade < high; ++decade) {
      for (int digit = 1; digit < 10; ++digit)
        body(at(digit * std::pow(10.0, decade)), digit == 1 ? "#c4c4c4" : "#ececec");
    }
    body(end, "#c4c4c4");
  }
};

std::string power_of_ten(int exponent) {
  return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", exponent);
}

std::string draw_panel(const PlotPanel& panel, double left, const std::string& x_label,
                       const std::string& y_label, std::span<const std::string> names) {
  const double right = left + kPlotWidth, top = kTop, bottom = kTop + kPlotHeight;
  const LogAxis x(panel.series, 0, left, right), y(panel.series, 1, bottom, top);
  std::string svg = text(0.5 * (left + right), top - 14, "middle", xml_escaped(panel.title), 14);
  x.for_each_grid_line([&](double at, const char* color) { svg += line(at, top, at, bottom, color, 1); });
  y.for_each_grid_line([&](double at, const char* color) { svg += line(left, at, right, at, color, 1); });
  for (int decade = x.low; decade <= x.high; ++decade)
    svg += text(x.at(std::pow(10.0, decade)), bottom + 18, "middle", power_of_ten(decade));
  for (int decade = y.low; decade <= y.high; ++decade)
    svg += text(left - 8, y.at(std::pow(10.0, decade)) + 4, "end", power_of_ten(decade));
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

}  // namespace

std::string plot_svg(std::span<const PlotPanel> panels, const std::string& x_label,
                     const std::string& y_label) {
  std::vector<std::string> names;
  for (const PlotPanel& panel : panels) {
    for (const PlotSeries& s : panel.series) {
      if (std::ranges::find(names, s.name) == names.end()) names.push_back(s.name);
    }
  }
  const double column = kLeft + kPlotWidth + kRight;
  const double width = column * static_cast<double>(std::max<std::size_t>(panels.size(), 1));
  const double height = kTop + kPlotHeight + kBottom + kLegendHeight;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" font-family=\"sans-serif\" fill=\"#222\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height);
  for (std::size_t i = 0; i < panels.size(); ++i)
    svg += draw_panel(panels[i], kLeft + column * static_cast<double>(i), x_label, y_label, names);
  double at = kLeft;
  const double legend_y = height - 14;
  for (std::size_t i = 0; i < names.size(); ++i) {
    svg += marker(i, at, legend_y - 4);
    svg += text(at + 10, legend_y, "start", xml_escaped(names[i]));
    at += 34 + 7.0 * static_cast<double>(names[i].size());
  }
  return svg + "</svg>\n";
}

}  // namespace vrc
