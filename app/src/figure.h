// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vrc {

/// A figure of [Zhao] as data: what `vrc figure` renders, and what it checks.

enum class FigureSize {
  kQuick,  ///< Small pictures, few rays and records: seconds.
  kFull,   ///< The paper's.
};

/// Named numbers in their order: "records", "gather_rays", "seconds", "cpu_seconds", "relmse" ...
using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// The value of that name; throws InputError when there is none.
[[nodiscard]] double number_of(const NamedNumbers& numbers, std::string_view name);

/// Makes a panel take as much CPU time as another one, which comes before it, by an option's number.
struct EqualTime {
  std::string panel;
  std::string option;  ///< "--records" or "--spp"
  int first = 16;      ///< Number to try first.
};

enum class PanelKind {
  kRender,     ///< `vrc render`.
  kReference,  ///< The mean of two `vrc render` that differ by --seed.
  /// A quantity of a method of `vrc derivatives`, shown as signed colours. Panels of a figure with the same
  /// words share one run.
  kDerivatives,
};

struct FigurePanel {
  std::string id;    ///< Stem of its files, unique in the figure.
  std::string name;  ///< For people.
  /// What a user would give to the command behind the scene, beside the group's words. Without files.
  std::string words = {};
  std::string reference = {};  ///< The panel of the group, before this one, that it is compared with.
  NamedNumbers paper = {};     ///< What the paper says of this picture.
  std::optional<EqualTime> equal_time = {};
  PanelKind kind = PanelKind::kRender;
  /// Of kDerivatives: that of `vrc derivatives`, or "difference" for analytic less no-glossy-glossy.
  std::string method = {};
  bool is_point = false;  ///< Of a curve: only its numbers are kept.
};

/// A panel run again with other values of an option: a line of plots.
struct FigureSeries {
  std::string panel;                ///< Of the group; the last point.
  std::string option;               ///< "--records", "--gather-rays", "--error" or "--spp"
  std::vector<std::string> values;  ///< Of the points before, as costs rise.
};

/// Plots of the errors of series over other numbers of the same runs.
struct FigureCurves {
  std::string id;     ///< Stem of their files, unique in the figure.
  std::string title;  ///< For people.
  std::vector<FigureSeries> series;
  std::vector<std::string> over;  ///< "cpu_seconds", "records" ...: a plot of those series that have it.
  std::string error = "relmse";
};

/// Pictures of one size and camera.
struct FigureGroup {
  std::string name;
  std::string scene;          ///< File in the folder of scenes.
  std::string words;          ///< Before those of every panel.
  std::string quantity = {};  ///< Of kDerivatives: "gradient" or "hessian".
  std::vector<FigurePanel> panels = {};
  std::vector<FigureCurves> curves = {};
};

/// The words of a text, between spaces.
[[nodiscard]] std::vector<std::string> words_of(const std::string& text);

/// What measures read of the finished panels.
class FigureValues {
 public:
  virtual ~FigureValues() = default;
  /// "relmse" and so on of a panel.
  [[nodiscard]] virtual double number(std::string_view panel, std::string_view name) const = 0;
  /// The records that the panel's record map holds, by column name.
  [[nodiscard]] virtual std::vector<std::vector<double>> records(
      std::string_view panel, const std::vector<std::string>& columns) const = 0;

  [[nodiscard]] double ratio(std::string_view panel, std::string_view of, std::string_view name) const {
    return number(panel, name) / number(of, name);
  }
};

struct FigureBound {
  bool at_least = true;  ///< Else at most.
  double limit = 0.0;

  [[nodiscard]] bool holds(double value) const { return at_least ? value >= limit : value <= limit; }
};

/// A number of the figure; with a bound, a claim of the paper that is checked.
struct FigureMeasure {
  std::string name;
  std::vector<std::string> panels;  ///< That it is made of.
  std::function<double(const FigureValues&)> value;
  std::optional<FigureBound> bound = {};
  std::optional<double> paper = {};
};

struct Figure {
  int number = 0;
  std::string title;
  std::string claim;
  std::vector<FigureGroup> groups = {};
  std::vector<FigureMeasure> measures = {};
};

/// The numbers of the figures that there are.
inline constexpr int kFirstFigure = 1, kLastFigure = 12;

/// Definition of a figure, kFirstFigure <= number <= kLastFigure.
[[nodiscard]] Figure figure_of_paper(int number, FigureSize size);

}  // namespace vrc
