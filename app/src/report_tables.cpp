// SPDX-License-Identifier: GPL-3.0-or-later
#include "report_tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/xml_text.h"
#include "report_numbers.h"

namespace vrc {
namespace {

/// A quantity that some panel has.
struct Column {
  std::string key;
  bool in_paper = false;
};

std::vector<Column> columns_of(const ReportGroup& group) {
  std::vector<Column> columns;
  const auto find_or_add = [&columns](const std::string& key) -> Column& {
    const auto found = std::ranges::find(columns, key, &Column::key);
    return found != columns.end() ? *found : columns.emplace_back(Column{key});
  };
  for (const ReportPanel& panel : group.panels) {
    for (const auto& [key, value] : panel.ours) find_or_add(key);
    for (const auto& [key, value] : panel.paper) find_or_add(key).in_paper = true;
  }
  return columns;
}

std::string cell(const ReportValues& values, const std::string& key, const char* css_class) {
  const auto found = std::ranges::find(values, key, &ReportValues::value_type::first);
  return fmt::format("<td class=\"{}\">{}</td>", css_class,
                     found == values.end() ? "" : xml_escaped(found->second));
}

/// With the signs of typography.
std::string bound_text(std::string bound) {
  for (const auto& [typed, sign] : {std::pair(">=", "\u2265"), std::pair("<=", "\u2264")}) {
    const std::size_t at = bound.find(typed);
    if (at != std::string::npos) bound.replace(at, 2, sign);
  }
  return bound;
}

/// A table that scrolls by itself where the page is narrow.
std::string scrolling(const std::string& label, const std::string& css_class, const std::string& rows) {
  return fmt::format(
      "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n<table class=\"{}\">\n{}"
      "</table>\n</div>\n",
      xml_escaped(label), css_class, rows);
}

}  // namespace

std::string panel_table(const ReportGroup& group) {
  const std::vector<Column> columns = columns_of(group);
  if (columns.empty()) return "";
  const bool paper = std::ranges::any_of(columns, &Column::in_paper);
  std::string first, second;
  for (const Column& column : columns) {
    const std::string title = xml_escaped(title_of(column.key));
    if (column.in_paper) {
      first += fmt::format("<th colspan=\"2\" scope=\"colgroup\">{}</th>", title);
      second += "<th scope=\"col\">ours</th><th scope=\"col\" class=\"paper\">paper</th>";
    } else {
      first += fmt::format("<th rowspan=\"{}\" scope=\"col\">{}</th>", paper ? 2 : 1, title);
    }
  }
  std::string rows = fmt::format(
      "<thead><tr><th rowspan=\"{}\" scope=\"col\" class=\"name\">method</th>{}</tr>", paper ? 2 : 1, first);
  if (paper) rows += fmt::format("<tr class=\"sub\">{}</tr>", second);
  rows += "</thead>\n<tbody>\n";
  for (const ReportPanel& panel : group.panels) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th>", xml_escaped(panel.name));
    for (const Column& column : columns) {
      rows += cell(panel.ours, column.key, "ours");
      if (column.in_paper) rows += cell(panel.paper, column.key, "paper");
    }
    rows += "</tr>\n";
  }
  return scrolling("Numbers of " + group.name, "panels", rows + "</tbody>\n");
}

std::string measure_table(const std::vector<ReportMeasure>& measures) {
  if (measures.empty()) return "";
  const bool paper = std::ranges::any_of(measures, [](const ReportMeasure& m) { return !m.paper.empty(); });
  std::string rows = fmt::format(
      "<thead><tr><th scope=\"col\" class=\"name\">measure</th><th scope=\"col\">value</th>{}"
      "<th scope=\"col\">bound</th><th scope=\"col\" class=\"verdict\">holds</th></tr></thead>\n<tbody>\n",
      paper ? "<th scope=\"col\" class=\"paper\">paper</th>" : "");
  for (const ReportMeasure& m : measures) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td class=\"ours\">{}</td>", xml_escaped(m.name),
                        xml_escaped(m.value));
    if (paper) rows += fmt::format("<td class=\"paper\">{}</td>", xml_escaped(m.paper));
    rows += fmt::format("<td>{}</td>", xml_escaped(bound_text(m.bound)));
    rows += !m.holds   ? "<td class=\"verdict\"></td></tr>\n"
            : *m.holds ? "<td class=\"verdict yes\">\u2713 yes</td></tr>\n"
                       : "<td class=\"verdict no\">\u2717 no</td></tr>\n";
  }
  return scrolling("What was measured", "measures", rows + "</tbody>\n");
}

}  // namespace vrc
