// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "report_numbers.h"

namespace vrc {
namespace {

/// "analytic_records_300"
std::string point_id(const FigureSeries& series, const std::string& value) {
  std::string option = series.option.substr(series.option.find_first_not_of('-'));
  std::ranges::replace(option, '-', '_');
  return fmt::format("{}_{}_{}", series.panel, option, value);
}

const FigurePanel& panel_of(const FigureGroup& group, const std::string& id) {
  const auto found = std::ranges::find(group.panels, id, &FigurePanel::id);
  VRC_CHECK(found != group.panels.end(), "curves of group '{}' name no panel of it: '{}'", group.name, id);
  return *found;
}

/// The words with the option's value in place of the one that they have, or at their end.
std::string words_with(const std::string& words, const std::string& option, const std::string& value) {
  std::vector<std::string> list = words_of(words);
  const auto found = std::ranges::find(list, option);
  if (found != list.end() && found + 1 != list.end())
    *(found + 1) = value;
  else
    list.insert(list.end(), {option, value});
  return fmt::format("{}", fmt::join(list, " "));
}

FigurePanel point_of(const FigureGroup& group, const FigureSeries& series, const std::string& value) {
  FigurePanel point = panel_of(group, series.panel);
  point.id = point_id(series, value);
  point.words = words_with(point.words, series.option, value);
  point.equal_time.reset();
  point.is_point = true;
  return point;
}

std::optional<double> positive_number(const PanelStamp& stamp, const std::string& name) {
  const auto found = std::ranges::find(stamp.numbers, name, &NamedNumbers::value_type::first);
  if (found == stamp.numbers.end() || !std::isfinite(found->second) || found->second <= 0.0)
    return std::nullopt;
  return found->second;
}

LabelledPlot plot_of(const FigureGroup& group, const FigureCurves& curves, const std::string& over,
                     const PanelStamps& stamps) {
  LabelledPlot plot{{curves.title, {}}, title_of(over), title_of(curves.error)};
  for (const FigureSeries& series : curves.series) {
    PlotSeries line{panel_of(group, series.panel).name, {}};
    for (const std::string& id : points_of(series)) {
      const auto stamp = stamps.find(id);
      if (stamp == stamps.end()) continue;
      const auto x = positive_number(stamp->second, over), y = positive_number(stamp->second, curves.error);
      if (x && y) line.points.emplace_back(*x, *y);
    }
    if (!line.points.empty()) plot.panel.series.push_back(std::move(line));
  }
  return plot;
}

}  // namespace

std::vector<std::string> points_of(const FigureSeries& series) {
  std::vector<std::string> ids;
  for (const std::string& value : series.values) ids.push_back(point_id(series, value));
  ids.push_back(series.panel);
  return ids;
}

std::vector<FigurePanel> runs_of(const FigureGroup& group) {
  std::vector<FigurePanel> runs = group.panels;
  for (const FigureCurves& curves : group.curves) {
    for (const FigureSeries& series : curves.series) {
      for (const std::string& value : series.values) {
        FigurePanel point = point_of(group, series, value);
        if (std::ranges::find(runs, point.id, &FigurePanel::id) == runs.end())
          runs.push_back(std::move(point));
      }
    }
  }
  return runs;
}

std::vector<DrawnCurves> drawn_curves(const Figure& figure, const PanelStamps& stamps) {
  std::vector<DrawnCurves> result;
  for (const FigureGroup& group : figure.groups) {
    for (const FigureCurves& curves : group.curves) {
      for (const std::string& over : curves.over) {
        LabelledPlot plot = plot_of(group, curves, over, stamps);
        if (!plot.panel.series.empty())
          result.push_back({fmt::format("{}_{}.svg", curves.id, over), std::move(plot)});
      }
    }
  }
  return result;
}

}  // namespace vrc
