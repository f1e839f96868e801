// SPDX-License-Identifier: GPL-3.0-or-later
#include "report_figure.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report_numbers.h"

namespace vrc {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kTable = "table.json";
constexpr const char* kFormat = "vrc figure 1";

/// A value of the file that knows where it stands, for messages: "groups[0].panels[2].image".
class Field {
 public:
  Field(const fs::path& file, const ordered_json& value, std::string name)
      : file_(file), value_(value), name_(std::move(name)) {}

  /// Nothing for what is missing or null.
  [[nodiscard]] std::optional<Field> find(const std::string& key) const {
    if (!value_.is_object()) fail("must be an object {...}");
    const auto found = value_.find(key);
    if (found == value_.end() || found->is_null()) return std::nullopt;
    return Field(file_, *found, member(key));
  }
  [[nodiscard]] Field at(const std::string& key) const {
    const std::optional<Field> found = find(key);
    if (!found) Field(file_, value_, member(key)).fail("is missing");
    return *found;
  }
  [[nodiscard]] std::string text() const {
    if (!value_.is_string()) fail("must be text");
    return value_.get<std::string>();
  }
  [[nodiscard]] std::string text_or_empty(const std::string& key) const {
    const std::optional<Field> found = find(key);
    return found ? found->text() : "";
  }
  [[nodiscard]] double number() const {
    if (!value_.is_number()) fail("must be a number");
    return value_.get<double>();
  }
  [[nodiscard]] bool truth() const {
    if (!value_.is_boolean()) fail("must be true or false");
    return value_.get<bool>();
  }
  /// Numbers, words and truths, as they are shown.
  [[nodiscard]] std::string shown() const {
    if (value_.is_string()) return value_.get<std::string>();
    if (value_.is_boolean()) return value_.get<bool>() ? "yes" : "no";
    if (value_.is_number_integer() && std::abs(number()) < 1e15) return readable(value_.get<std::int64_t>());
    return readable(number());
  }
  [[nodiscard]] std::string shown_or_empty(const std::string& key) const {
    const std::optional<Field> found = find(key);
    return found ? found->shown() : "";
  }
  [[nodiscard]] std::vector<Field> items() const {
    if (!value_.is_array()) fail("must be a list [...]");
    std::vector<Field> result;
    for (std::size_t i = 0; i < value_.size(); ++i)
      result.emplace_back(file_, value_[i], fmt::format("{}[{}]", name_, i));
    return result;
  }
  [[nodiscard]] std::vector<Field> items_or_none(const std::string& key) const {
    const std::optional<Field> found = find(key);
    return found ? found->items() : std::vector<Field>();
  }
  [[nodiscard]] ReportValues values_or_none(const std::string& key) const {
    ReportValues result;
    const std::optional<Field> found = find(key);
    if (!found) return result;
    if (!found->value_.is_object()) found->fail("must be an object {...}");
    for (const auto& [name, value] : found->value_.items()) {
      if (!value.is_null()) result.emplace_back(name, Field(file_, value, found->member(name)).shown());
    }
    return result;
  }
  /// Of a file beside the table.
  [[nodiscard]] fs::path file_name() const {
    const fs::path name = text();
    if (name.empty() || name.filename() != name || name == "." || name == "..")
      fail(fmt::format("must be the name of a file in the folder, not '{}'", name.string()));
    const fs::path path = file_.parent_path() / name;
    if (!fs::is_regular_file(path)) {
      throw InputError(
          path.string(), 0,
          fmt::format("is missing, but {} names it in {}; make the figure again", file_.string(), name_));
    }
    return path;
  }
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file_.string(), 0,
                     fmt::format("{} {}; make the figure again, or correct it",
                                 name_.empty() ? "the whole" : name_, problem));
  }

 private:
  [[nodiscard]] std::string member(const std::string& key) const {
    return name_.empty() ? key : name_ + "." + key;
  }

  const fs::path& file_;
  const ordered_json& value_;
  std::string name_;
};

ReportPanel panel_of(const Field& field) {
  ReportPanel panel;
  panel.id = field.at("id").text();
  panel.name = field.at("name").text();
  panel.scene = field.text_or_empty("scene");
  panel.command = field.text_or_empty("command");
  panel.image = field.at("image").file_name();
  if (const auto records = field.find("records")) panel.records = records->file_name();
  panel.ours = field.values_or_none("ours");
  panel.paper = field.values_or_none("paper");
  return panel;
}

ReportGroup group_of(const Field& field) {
  ReportGroup group{field.at("name").text(), {}};
  const std::vector<Field> panels = field.at("panels").items();
  for (const Field& panel : panels) group.panels.push_back(panel_of(panel));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const auto reference = panels[i].find("reference");
    if (!reference) continue;
    const auto found = std::ranges::find(group.panels, reference->text(), &ReportPanel::id);
    if (found == group.panels.end())
      reference->fail(fmt::format("names no panel of its group: '{}'", reference->text()));
    const auto index = static_cast<std::size_t>(found - group.panels.begin());
    if (index != i) group.panels[i].reference = index;
  }
  return group;
}

ReportMeasure measure_of(const Field& field) {
  ReportMeasure measure{field.at("name").text(), field.at("value").shown(), field.shown_or_empty("bound"),
                        field.shown_or_empty("paper"), std::nullopt};
  if (const auto holds = field.find("holds")) measure.holds = holds->truth();
  return measure;
}

Vec2 point_of(const Field& field) {
  const std::vector<Field> coordinates = field.items();
  if (coordinates.size() != 2) field.fail("must be a pair [x, y]");
  return {coordinates[0].number(), coordinates[1].number()};
}

LabelledPlot curves_of(const Field& field) {
  LabelledPlot curves{{field.text_or_empty("title"), {}}, field.text_or_empty("x"), field.text_or_empty("y")};
  for (const Field& series : field.at("series").items()) {
    PlotSeries& added = curves.panel.series.emplace_back(PlotSeries{series.at("name").text(), {}});
    for (const Field& point : series.at("points").items()) added.points.push_back(point_of(point));
  }
  return curves;
}

ordered_json read_table(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), 0, "cannot be opened; give a folder that holds a figure");
  try {
    return ordered_json::parse(in);
  } catch (const ordered_json::exception& error) {
    throw InputError(file.string(), 0, fmt::format("is no JSON ({}); make the figure again", error.what()));
  }
}

std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (fs::is_regular_file(entry.path() / kTable)) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace

ReportFigure read_report_figure(const fs::path& folder) {
  const fs::path file = folder / kTable;
  const ordered_json table = read_table(file);
  const Field root(file, table, "");
  const Field format = root.at("format");
  if (format.text() != kFormat)
    format.fail(fmt::format("is '{}', but this program reads '{}'", format.text(), kFormat));
  ReportFigure figure;
  const double number = root.at("figure").number();
  if (!(number >= 0.0 && number < 1e6 && number == std::floor(number)))
    root.at("figure").fail("must be a whole number");
  figure.number = static_cast<int>(number);
  figure.title = root.at("title").text();
  figure.claim = root.text_or_empty("claim");
  figure.size = root.text_or_empty("size");
  for (const Field& group : root.items_or_none("groups")) figure.groups.push_back(group_of(group));
  for (const Field& measure : root.items_or_none("measures")) figure.measures.push_back(measure_of(measure));
  for (const Field& curves : root.items_or_none("curves")) figure.curves.push_back(curves_of(curves));
  return figure;
}

std::vector<fs::path> figure_folders(std::span<const fs::path> folders) {
  std::vector<fs::path> result;
  const auto add = [&result](const fs::path& folder) {
    const fs::path resolved = fs::weakly_canonical(folder);
    const auto same = [&](const fs::path& other) { return fs::weakly_canonical(other) == resolved; };
    if (std::ranges::none_of(result, same)) result.push_back(folder);
  };
  for (const fs::path& folder : folders) {
    if (!fs::is_directory(folder))
      throw InputError(folder.string(), 0, "is no folder; give that of a figure");
    if (fs::is_regular_file(folder / kTable)) {
      add(folder);
      continue;
    }
    const std::vector<fs::path> inside = folders_in(folder);
    if (inside.empty())
      throw InputError(folder.string(), 0,
                       "holds no table.json, nor do its folders; give what 'vrc figure -o' wrote");
    std::ranges::for_each(inside, add);
  }
  return result;
}

}  // namespace vrc
