// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of whole scenes, compared with path tracing at equal time.
#include "figure_parts.h"

namespace vrc {

Figure figure_9(FigureSize size) {
  Figure figure;
  figure.title = "GGX surfaces";
  figure.claim =
      "Records follow the sharper reflections of GGX; at equal time path tracing has larger errors.";
  const int side = pick(size, 192, 512);
  const std::string records = records_words(pick(size, 1200, 5000), pick(size, 2048, 8192));
  FigureGroup group{"cornell_ggx", "cornell_ggx.xml", indirect_words(side, side)};
  group.panels = {
      reference_panel("reference", size),
      {"paper", "The paper's records", "--preset paper " + records, "reference"},
      {"path", "Path tracing", "--method path", "reference", {}, EqualTime{"paper", "--spp", 16}},
      {"ours", "This program's defaults", records, "reference"},
  };
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, path tracing over the paper's records", "path", "paper", "relmse",
                    at_least(5.0)),
      ratio_measure("relMSE, the paper's records over defaults", "paper", "ours", "relmse", {}),
  };
  return figure;
}

Figure figure_10(FigureSize size) { return figure_9(size); }
Figure figure_12(FigureSize size) { return figure_9(size); }

}  // namespace vrc
