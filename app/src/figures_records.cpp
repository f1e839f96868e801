// SPDX-License-Identifier: GPL-3.0-or-later
// Figures about where records are and how they are interpolated.
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

}  // namespace

Figure figure_1(FigureSize size) {
  Figure figure;
  figure.title = "Records of the view-dependent and the view-independent strategy";
  figure.claim =
      "The view-independent strategy spreads records nearly evenly; the view-dependent one puts them where "
      "the "
      "Hessian of the radiance towards the camera is large.";
  const int side = pick(size, 192, 512);
  const std::string records = records_words(pick(size, 600, 2000), pick(size, 2048, 8192));
  FigureGroup group{"half_box", "half_box.xml", indirect_words(side, side)};
  group.panels = {
      reference_panel("reference", size),
      {"view_dependent", "View-dependent", "--preset paper " + records, "reference", {{"records", 2000}}},
      {"view_independent",
       "View-independent, outgoing radiance",
       "--preset paper --representation analytic --strategy view-independent-outgoing " + records,
       "reference",
       {{"records", 2000}}},
  };
  figure.groups = {group};
  figure.measures = {
      density_measure("density of view-dependent records against |Hessian|, rank correlation",
                      "view_dependent", &RecordDensity::correlation, at_least(0.5)),
      {"variation of the density, view-dependent over view-independent",
       {"view_dependent", "view_independent"},
       [](const FigureValues& values) {
         const auto probes = values.records("view_independent", density_columns());
         const auto records_of = values.records("view_dependent", density_columns());
         return record_density(records_of, probes).variation / record_density(probes, probes).variation;
       },
       at_least(1.5)},
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
  figure.claim = "With the same 700 records, each order of the polynomial lowers the error.";
  const int side = pick(size, 192, 512);
  const std::string words = "--preset paper " + records_words(700, 8192);
  FigureGroup group{"half_box", "half_box.xml", indirect_words(side, side)};
  group.panels = {reference_panel("reference", size)};
  for (const int order : {0, 1, 2}) {
    group.panels.push_back({"order_" + std::to_string(order),
                            "Order " + std::to_string(order),
                            words + " --taylor-order " + std::to_string(order),
                            "reference",
                            {{"records", 700}}});
  }
  group.panels.push_back({"ours", "This program's defaults, order 2", records_words(700, 8192), "reference"});
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, order 0 over order 1", "order_0", "order_1", "relmse", at_least(1.5)),
      ratio_measure("relMSE, order 1 over order 2", "order_1", "order_2", "relmse", at_least(1.5)),
      ratio_measure("relMSE, order 2 over defaults", "order_2", "ours", "relmse", {}),
  };
  return figure;
}

Figure figure_8(FigureSize size) {
  Figure figure;
  figure.title = "Placement strategies with equally many records";
  figure.claim =
      "With 2000 records the view-dependent strategy has a lower error than the view-independent one, and "
      "that "
      "with interpolated radiance a lower one than with interpolated spherical harmonics.";
  const int side = pick(size, 192, 512);
  const std::string records = records_words(pick(size, 700, 2000), pick(size, 2048, 8192));
  FigureGroup group{"cornell_glossy", "cornell_glossy.xml", indirect_words(side, side)};
  const NamedNumbers paper = {{"records", 2000}, {"gather_rays", 8192}};
  group.panels = {
      reference_panel("reference", size),
      {"view_dependent", "View-dependent, radiance", "--preset paper " + records, "reference", paper},
      {"outgoing", "View-independent, radiance",
       "--preset paper --representation analytic --strategy view-independent-outgoing " + records,
       "reference", paper},
      {"harmonics", "View-independent, spherical harmonics",
       "--preset paper --representation sh --sh-order 10 --strategy view-independent " + records, "reference",
       paper},
      {"ours", "This program's defaults", records, "reference"},
  };
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, view-independent radiance over view-dependent", "outgoing", "view_dependent",
                    "relmse", at_least(1.1)),
      ratio_measure("relMSE, view-independent harmonics over view-independent radiance", "harmonics",
                    "outgoing", "relmse", at_least(1.5)),
      ratio_measure("relMSE, view-dependent over defaults", "view_dependent", "ours", "relmse", {}),
  };
  return figure;
}

}  // namespace vrc
