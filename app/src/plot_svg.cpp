// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/xml_text.h"
#include "plot_axis.h"

namespace vrc {
namespace {

// Lengths in pixels of the document.
constexpr double kPlotWidth = 300, kPlotHeight = 240;
constexpr double kLeft = 64, kTop = 34, kRight = 24, kBottom = 48, kLegendHeight = 12;
constexpr double kMarker = 3.5;
constexpr double kLegendRow = 18, kLegendLetter = 6.6, kLegendGap = 40, kLegendLeft = 26, kLegendLine = 11;
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73",
                                "#cc79a7", "#56b4e9", "#e69f00"};  // [OkabeIto2008]
constexpr std::size_t kShapes = 5;
// Lines that lie on each other stay visible, also without colours.
constexpr std::array kDashes = {"none", "8 4", "2 3", "10 3 2 3"};

/// Colour and dashes of a series' line.
std::string stroke(std::size_t series) {
  return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-dasharray=\"{}\"",
                     kColors[series % kColors.size()], kDashes[series % kDashes.size()]);
}

std::string text(double x, double y, const char* anchor, const std::string& content, int size = 12,
                 const std::string& attributes = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" text-anchor=\"{}\"{}>{}</text>\n", x,
                     y, size, anchor, attributes, content);
}

/// In the colour of the text, paler.
std::string grid_line(double x0, double y0, double x1, double y1, bool pale) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"currentColor\" "
      "stroke-opacity=\"{}\"/>\n",
      x0, y0, x1, y1, pale ? 0.08 : 0.25);
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

/// That holds the coordinate of all points.
PlotAxis axis_of(std::span<const PlotSeries> series, int coordinate, double begin, double end) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const PlotSeries& s : series) {
    for (const Vec2& p : s.points) {
      least = std::min(least, p[coordinate]);
      most = std::max(most, p[coordinate]);
    }
  }
  return least <= most ? PlotAxis(least, most, begin, end) : PlotAxis(1.0, 10.0, begin, end);
}

std::string draw_panel(const PlotPanel& panel, double left, const std::string& x_label,
                       const std::string& y_label, std::span<const std::string> names) {
  const double right = left + kPlotWidth, top = kTop, bottom = kTop + kPlotHeight;
  const PlotAxis x = axis_of(panel.series, 0, left, right), y = axis_of(panel.series, 1, bottom, top);
  std::string svg = text(0.5 * (left + right), top - 14, "middle", xml_escaped(panel.title), 14);
  for (const PlotTick& tick : x.ticks()) {
    svg += grid_line(tick.at, top, tick.at, bottom, tick.label.empty());
    if (!tick.label.empty()) svg += text(tick.at, bottom + 18, "middle", tick.label);
  }
  for (const PlotTick& tick : y.ticks()) {
    svg += grid_line(left, tick.at, right, tick.at, tick.label.empty());
    if (!tick.label.empty()) svg += text(left - 8, tick.at + 4, "end", tick.label);
  }
  svg += text(0.5 * (left + right), bottom + 38, "middle", xml_escaped(x_label));
  const double label_x = left - 48, label_y = 0.5 * (top + bottom);
  svg += text(label_x, label_y, "middle", xml_escaped(y_label), 12,
              fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", label_x, label_y));
  for (const PlotSeries& s : panel.series) {
    const auto shape = static_cast<std::size_t>(std::ranges::find(names, s.name) - names.begin());
    std::string path;
    for (const Vec2& p : s.points) path += fmt::format("{:.1f},{:.1f} ", x.at(p.x()), y.at(p.y()));
    svg += fmt::format("<polyline points=\"{}\" {}/>\n", path, stroke(shape));
    for (const Vec2& p : s.points) svg += marker(shape, x.at(p.x()), y.at(p.y()));
  }
  return svg;
}

/// Lines, shapes and names of the series in rows, the first `top` from the document's upper border; `height`
/// becomes that of all.
std::string draw_legend(std::span<const std::string> names, double width, double top, double& height) {
  std::string svg;
  double at = kLegendLeft, y = top;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double length = kLegendLetter * static_cast<double>(names[i].size());
    if (at > kLegendLeft && at + kLegendLine + 5 + length > width) {
      at = kLegendLeft;
      y += kLegendRow;
    }
    svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n",
                       at - kLegendLine, y - 4, at + kLegendLine, y - 4, stroke(i));
    svg += marker(i, at, y - 4);
    svg += text(at + kLegendLine + 5, y, "start", xml_escaped(names[i]));
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

std::string plot_svg(const LabelledPlot& plot, PlotPaper paper) {
  return plot_svg(std::span(&plot.panel, 1), plot.x_label, plot.y_label, paper);
}

}  // namespace vrc
