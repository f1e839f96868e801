// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace vrc {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const NamedNumbers& numbers) {
  Json json = Json::object();
  for (const auto& [name, value] : numbers) {
    if (!std::isfinite(value)) continue;
    const double whole = std::round(value);
    if (whole == value && std::abs(value) < 1e15)
      json[name] = static_cast<std::int64_t>(value);
    else
      json[name] = value;
  }
  return json;
}

Json as_json(const FigureGroup& group, const FigurePanel& panel, const PanelStamp& stamp) {
  Json json{{"id", panel.id},
            {"name", panel.name},
            {"scene", group.scene},
            {"command", stamp.command},
            {"image", stamp.files[0]}};
  const auto add_file = [&](const char* field, const std::string& file) {
    if (std::ranges::find(stamp.files, file) != stamp.files.end()) json[field] = file;
  };
  add_file("png", panel.id + ".png");
  if (!panel.reference.empty()) json["reference"] = panel.reference;
  add_file("error", panel.id + "_error.png");
  add_file("records", panel.id + "_records.csv");
  add_file("overlay", panel.id + "_records.png");
  json["ours"] = as_json(stamp.numbers);
  if (!panel.paper.empty()) json["paper"] = as_json(panel.paper);
  return json;
}

Json as_json(const DrawnCurves& curves) {
  Json series = Json::array();
  for (const PlotSeries& s : curves.plot.panel.series) {
    Json points = Json::array();
    for (const Vec2& p : s.points) points.push_back({p.x(), p.y()});
    series.push_back({{"name", s.name}, {"points", std::move(points)}});
  }
  return {{"title", curves.plot.panel.title},
          {"x", curves.plot.x_label},
          {"y", curves.plot.y_label},
          {"svg", curves.file},
          {"series", std::move(series)}};
}

}  // namespace

std::string bound_text(const FigureBound& bound) {
  return fmt::format("{} {:g}", bound.at_least ? ">=" : "<=", bound.limit);
}

std::string figure_table(const Figure& figure, FigureSize size, const PanelStamps& stamps,
                         std::span<const MeasuredValue> values, std::span<const DrawnCurves> curves) {
  Json groups = Json::array();
  for (const FigureGroup& group : figure.groups) {
    Json panels = Json::array();
    for (const FigurePanel& panel : group.panels) {
      const auto stamp = stamps.find(panel.id);
      if (stamp != stamps.end()) panels.push_back(as_json(group, panel, stamp->second));
    }
    if (!panels.empty()) groups.push_back({{"name", group.name}, {"panels", std::move(panels)}});
  }
  Json measures = Json::array();
  for (const MeasuredValue& value : values) {
    if (!std::isfinite(value.value)) continue;
    Json measure{{"name", value.measure->name}, {"value", value.value}};
    if (value.measure->bound) {
      measure["bound"] = bound_text(*value.measure->bound);
      measure["holds"] = value.holds();
    }
    if (value.measure->paper) measure["paper"] = *value.measure->paper;
    measures.push_back(std::move(measure));
  }
  Json drawn = Json::array();
  for (const DrawnCurves& c : curves) drawn.push_back(as_json(c));
  const Json table{{"format", "vrc figure 1"},
                   {"figure", figure.number},
                   {"title", figure.title},
                   {"claim", figure.claim},
                   {"size", size == FigureSize::kQuick ? "quick" : "full"},
                   {"groups", std::move(groups)},
                   {"measures", std::move(measures)},
                   {"curves", std::move(drawn)}};
  return table.dump(2) + "\n";
}

}  // namespace vrc
