// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_run.h"

#include <cmath>
#include <iostream>

#include "app/progress.h"
#include "core/error.h"
#include "figure_table.h"
#include "io/atomic_file.h"
#include "io/scene_reader.h"
#include "record_table.h"

namespace vrc {
namespace fs = std::filesystem;
namespace {

/// Hashes of what the files of scenes hold, by scene and definitions.
class SceneKeys {
 public:
  explicit SceneKeys(fs::path scenes) : scenes_(std::move(scenes)) {}

  std::uint64_t of(const FigureGroup& group, const FigurePanel& panel) {
    SceneReadOptions options;
    std::string name = group.scene;
    const std::vector<std::string> words = words_of(group.words + " " + panel.words);
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
      if (words[i] != "-D") continue;
      const std::size_t equals = words[i + 1].find('=');
      options.defines[words[i + 1].substr(0, equals)] = words[i + 1].substr(equals + 1);
      name += " " + words[i + 1];
    }
    const auto known = keys_.find(name);
    if (known != keys_.end()) return known->second;
    const std::uint64_t key =
        hash_files(hash_bytes(0, name), read_scene(scenes_ / group.scene, options).files);
    keys_.emplace(name, key);
    return key;
  }

 private:
  fs::path scenes_;
  std::map<std::string, std::uint64_t> keys_;
};

/// Reads what measures want from the stamps and files.
class FinishedPanels : public FigureValues {
 public:
  FinishedPanels(fs::path folder, const PanelStamps& stamps) : folder_(std::move(folder)), stamps_(stamps) {}

  double number(std::string_view panel, std::string_view name) const override {
    return number_of(stamps_.find(panel)->second.numbers, name);
  }

  std::vector<std::vector<double>> records(std::string_view panel,
                                           const std::vector<std::string>& columns) const override {
    const std::vector<std::string_view> required(columns.begin(), columns.end());
    RecordTable table(folder_ / fmt::format("{}_records.csv", panel), required);
    std::vector<std::vector<double>> rows;
    while (table.next()) {
      std::vector<double>& row = rows.emplace_back();
      for (const std::string& column : columns) row.push_back(table.number<double>(column));
    }
    return rows;
  }

 private:
  fs::path folder_;
  const PanelStamps& stamps_;
};

std::vector<MeasuredValue> measure(const Figure& figure, const fs::path& folder, const PanelStamps& stamps) {
  std::vector<MeasuredValue> values;
  for (const FigureMeasure& m : figure.measures) {
    const auto there = [&](const std::string& id) { return stamps.contains(id); };
    if (std::ranges::all_of(m.panels, there)) values.push_back({&m, m.value(FinishedPanels(folder, stamps))});
  }
  return values;
}

void print(int figure, const FigurePanel& panel, const MadePanel& made) {
  std::string line = fmt::format("figure {}, {}:", figure, panel.id);
  for (const auto& [name, value] : made.stamp.numbers) line += fmt::format(" {} {:.4g},", name, value);
  line.back() = ' ';
  std::cout << line << (made.kept ? "(kept)" : "") << std::endl;
}

void print(int figure, const MeasuredValue& value) {
  std::cout << fmt::format("figure {}: {}: {:.3g}", figure, value.measure->name, value.value);
  if (value.measure->bound) {
    std::cout << fmt::format(" ({}) {}", bound_text(*value.measure->bound),
                             value.holds() ? "holds" : "DOES NOT HOLD");
  }
  std::cout << std::endl;
}

fs::path make_folder(const FigureOptions& options, int number) {
  const fs::path folder = options.output / figure_folder_name(number);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), 0, fmt::format("cannot be made: {}", error.message()));
  require_writable(folder / "table.json");
  return folder;
}

}  // namespace

std::string figure_folder_name(int number) { return fmt::format("figure_{:02}", number); }

FigureOutcome make_figure(const Figure& figure, const FigureOptions& options, const std::atomic<bool>& stop) {
  const PanelPlace place = {make_folder(options, figure.number), options.scenes, options.threads,
                            options.quiet, options.restart};
  SceneKeys scene_keys(options.scenes);
  PanelStamps stamps;
  FigureOutcome outcome;
  try {
    for (const FigureGroup& group : figure.groups) {
      for (const FigurePanel& panel : runs_of(group)) {
        if (stop) throw Interrupted();
        const MadePanel made = make_panel(group, panel, scene_keys.of(group, panel), stamps, place, stop);
        print(figure.number, panel, made);
        stamps.emplace(panel.id, made.stamp);
      }
    }
  } catch (const Interrupted&) {
    outcome.interrupted = true;
  }
  const std::vector<MeasuredValue> values = measure(figure, place.folder, stamps);
  const std::vector<DrawnCurves> curves = drawn_curves(figure, stamps);
  for (const DrawnCurves& c : curves) write_file_atomically(place.folder / c.file, plot_svg(c.plot));
  write_file_atomically(place.folder / "table.json",
                        figure_table(figure, options.size, stamps, values, curves));
  for (const MeasuredValue& value : values) {
    print(figure.number, value);
    if (!value.holds()) ++outcome.failed;
  }
  return outcome;
}

}  // namespace vrc
