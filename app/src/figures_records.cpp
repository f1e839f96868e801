// SPDX-License-Identifier: GPL-3.0-or-later
// Figures about where records are and how they are interpolated.
#include <fmt/format.h>

#include "figure_density.h"
#include "figure_parts.h"

namespace vrc {
namespace {

FigureMeasure density_measure(std::string name, std::string panel, double RecordDensity::*number,
                              std::optional<FigureBound> bound) {
  return {std::move(name),
          {panel, "view_independent"},
          [=](const FigureValues& values) {
            const auto probes = values.records("view_independent", density_columns());
            return record_density(values.records(panel, density_columns()), probes).*number;
          },
          bound};
}

/// Of series of the orders 0, 1, 2: each falls as records grow, below that of the order before.
void add_order_measures(Figure& figure, const std::string& scene, const std::vector<FigureSeries>& orders) {
  for (int order = 0; order <= 2; ++order) {
    const auto at = static_cast<std::size_t>(order);
    figure.measures.push_back(
        falling_measure(fmt::format("{}: relMSE along its curve, largest step, order {}", scene, order),
                        orders[at], "relmse", at_most(1.0)));
    if (order == 0) continue;
    figure.measures.push_back(
        above_measure(fmt::format("{}: relMSE along the curves, smallest ratio, order {} over order {}",
                                  scene, order - 1, order),
                      orders[at - 1], orders[at], "relmse", at_least(1.0)));
  }
}

}  // namespace

Figure figure_1(FigureSize size) {
  Figure figure;
  figure.title = "Records of the view-dependent and the view-independent strategy";
  figure.claim =
      "The view-independent strategy spreads records nearly evenly; the view-dependent one puts them where "
      "the Hessian of the radiance towards the camera is large.";
  const int side = pick(size, 160, 512);
  const std::string records = records_words(pick(size, 800, 2000), pick(size, 4096, 8192));
  FigureGroup group{"half_box", "half_box.xml", indirect_words(side, side)};
  group.panels = {
      reference_panel("reference", size),
      {"view_dependent", "View-dependent", "--preset paper " + records, "reference", {{"records", 2000}}},
      {"view_independent",
       "View-independent, outgoing radiance",
       "--preset paper --representation analytic --sh-order 10 --strategy view-independent-outgoing " +
           records,
       "reference",
       {{"records", 2000}}},
  };
  figure.groups = {group};
  figure.measures = {
      density_measure("density of view-dependent records against |Hessian|, rank correlation",
                      "view_dependent", &RecordDensity::correlation, at_least(0.5)),
      density_measure("the same beyond the density of view-independent records, partial rank correlation",
                      "view_dependent", &RecordDensity::own_correlation, at_least(0.25)),
      ratio_measure("relMSE, view-independent over view-dependent", "view_independent", "view_dependent",
                    "relmse", at_least(1.1)),
      density_measure("density of view-independent records against |Hessian|, rank correlation",
                      "view_independent", &RecordDensity::correlation, {}),
      density_measure("variation of the density, view-dependent", "view_dependent", &RecordDensity::variation,
                      {}),
      density_measure("variation of the density, view-independent", "view_independent",
                      &RecordDensity::variation, {}),
  };
  return figure;
}

Figure figure_6(FigureSize size) {
  Figure figure;
  figure.title = "Orders of Taylor extrapolation";
  figure.claim =
      "With the same 700 records, each order of the polynomial lowers the error; where noise of the records "
      "weighs more (the half box), the second order gains little.";
  const int side = pick(size, 160, 512);
  constexpr int kRecords = 700;
  const std::string words = "--preset paper " + records_words(kRecords, 8192);
  for (const char* scene : {"glossy_pair", "half_box"}) {
    const std::string prefix = std::string(scene) + "_";
    const bool clean = prefix == "glossy_pair_";
    FigureGroup group{scene, std::string(scene) + ".xml",
                      indirect_words(side, side) + (clean ? " --exposure -1.5" : "")};
    group.panels = {reference_panel(prefix + "reference", size)};
    FigureCurves curves{prefix + "curve",
                        clean ? "Glossy pair, 8192 rays a record" : "Half box, 8192 rays a record",
                        {},
                        {"records"}};
    for (const int order : {0, 1, 2}) {
      const std::string digit = std::to_string(order);
      group.panels.push_back({prefix + "order_" + digit,
                              "Order " + digit,
                              words + " --taylor-order " + digit,
                              prefix + "reference",
                              {{"records", kRecords}}});
      curves.series.push_back(records_series(prefix + "order_" + digit, kRecords));
    }
    group.panels.push_back({prefix + "ours", "This program's defaults, order 2",
                            records_words(kRecords, 8192), prefix + "reference"});
    curves.series.push_back(records_series(prefix + "ours", kRecords));
    group.curves = {curves};
    figure.groups.push_back(group);
    const auto bound = [&](double limit) { return clean ? std::optional(at_least(limit)) : std::nullopt; };
    figure.measures.push_back(ratio_measure(std::string(scene) + ": relMSE, order 0 over order 1",
                                            prefix + "order_0", prefix + "order_1", "relmse", at_least(1.5)));
    figure.measures.push_back(ratio_measure(std::string(scene) + ": relMSE, order 1 over order 2",
                                            prefix + "order_1", prefix + "order_2", "relmse", bound(1.5)));
    figure.measures.push_back(ratio_measure(std::string(scene) + ": relMSE, order 2 over defaults",
                                            prefix + "order_2", prefix + "ours", "relmse", {}));
    if (clean) add_order_measures(figure, scene, curves.series);
  }
  return figure;
}

Figure figure_8(FigureSize size) {
  Figure figure;
  figure.title = "Placement strategies with equally many records";
  figure.claim =
      "With 2000 records the view-dependent strategy has a lower error than the view-independent one, and "
      "that with interpolated radiance a lower one than with interpolated spherical harmonics.";
  const int side = pick(size, 160, 512);
  const int count = pick(size, 700, 2000);
  const std::string records = records_words(count, 8192);
  FigureGroup group{"cornell_glossy", "cornell_glossy.xml", indirect_words(side, side) + " --exposure 1.5"};
  const NamedNumbers paper = {{"records", 2000}, {"gather_rays", 8192}};
  group.panels = {
      reference_panel("reference", size),
      {"view_dependent", "View-dependent, radiance", "--preset paper " + records, "reference", paper},
      {"outgoing", "View-independent, radiance",
       "--preset paper --representation analytic --sh-order 10 --strategy view-independent-outgoing " +
           records,
       "reference", paper},
      {"harmonics", "View-independent, spherical harmonics",
       "--preset paper --representation sh --sh-order 10 --strategy view-independent " + records, "reference",
       paper},
      {"ours", "This program's defaults", records, "reference"},
  };
  const FigureSeries view_dependent = records_series("view_dependent", count);
  group.curves = {{"curve",
                   "Glossy Cornell box, 8192 rays a record",
                   {view_dependent, records_series("outgoing", count), records_series("harmonics", count),
                    records_series("ours", count)},
                   {"records", "cpu_seconds"}}};
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, view-independent radiance over view-dependent", "outgoing", "view_dependent",
                    "relmse", at_least(1.1)),
      ratio_measure("relMSE, view-independent harmonics over view-independent radiance", "harmonics",
                    "outgoing", "relmse", at_least(1.5)),
      falling_measure("view-dependent: relMSE along its curve, largest step", view_dependent, "relmse",
                      at_most(1.0)),
      above_measure("relMSE along the curves, smallest ratio, view-independent harmonics over view-dependent",
                    records_series("harmonics", count), view_dependent, "relmse", at_least(1.0)),
      ratio_measure("relMSE, view-dependent over defaults", "view_dependent", "ours", "relmse", {}),
  };
  return figure;
}

}  // namespace vrc
