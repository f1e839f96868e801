// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_parts.h"

#include <fmt/format.h>

namespace vrc {

std::string indirect_words(int width, int height) {
  return fmt::format("--only indirect --bounces 1 --size {}x{}", width, height);
}

FigurePanel reference_panel(std::string id, int spp, int rays) {
  FigurePanel panel;
  panel.id = std::move(id);
  panel.name = "Reference";
  panel.words = fmt::format("--method path --spp {} --path-rays {}", spp, rays);
  panel.kind = PanelKind::kReference;
  return panel;
}

FigurePanel reference_panel(std::string id, FigureSize size) {
  return reference_panel(std::move(id), pick(size, 32, 64), pick(size, 512, 4096));
}

std::string records_words(int records, int gather_rays) {
  return fmt::format("--records {} --gather-rays {}", records, gather_rays);
}

FigureMeasure ratio_measure(std::string name, const std::string& panel, const std::string& of,
                            const std::string& number, std::optional<FigureBound> bound,
                            std::optional<double> paper) {
  return {std::move(name),
          {panel, of},
          [=](const FigureValues& values) { return values.ratio(panel, of, number); },
          bound,
          paper};
}

FigureMeasure panel_measure(std::string name, const std::string& panel, const std::string& number,
                            std::optional<FigureBound> bound, std::optional<double> paper) {
  return {std::move(name),
          {panel},
          [=](const FigureValues& values) { return values.number(panel, number); },
          bound,
          paper};
}

}  // namespace vrc
