// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "figure_curves.h"

namespace vrc {
namespace {

/// Points at these shares of the option's number, rising.
FigureSeries shares_series(const std::string& panel, const std::string& option, int number,
                           const std::vector<double>& shares) {
  FigureSeries series{panel, option, {}};
  for (const double share : shares) series.values.push_back(std::to_string(std::lround(share * number)));
  return series;
}

}  // namespace

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

FigureMeasure falling_measure(std::string name, const FigureSeries& series, const std::string& number,
                              std::optional<FigureBound> bound) {
  const std::vector<std::string> points = points_of(series);
  return {std::move(name), points,
          [=](const FigureValues& values) {
            double worst = -HUGE_VAL;
            for (std::size_t i = 1; i < points.size(); ++i)
              worst = std::max(worst, values.ratio(points[i], points[i - 1], number));
            return worst;
          },
          bound};
}

FigureMeasure above_measure(std::string name, const FigureSeries& upper, const FigureSeries& lower,
                            const std::string& number, std::optional<FigureBound> bound) {
  const std::vector<std::string> above = points_of(upper), below = points_of(lower);
  VRC_CHECK(above.size() == below.size(), "series of {} and {} points", above.size(), below.size());
  std::vector<std::string> all = above;
  all.insert(all.end(), below.begin(), below.end());
  return {std::move(name), all,
          [=](const FigureValues& values) {
            double least = HUGE_VAL;
            for (std::size_t i = 0; i < above.size(); ++i)
              least = std::min(least, values.ratio(above[i], below[i], number));
            return least;
          },
          bound};
}

FigureSeries samples_series(const std::string& panel) { return {panel, "--spp", {"16", "32", "64"}}; }

FigureSeries rays_series(const std::string& panel, int most) {
  return shares_series(panel, "--gather-rays", most, {0.125, 0.25, 0.5});
}

FigureSeries records_series(const std::string& panel, int most) {
  return shares_series(panel, "--records", most, {0.25, 0.4, 0.63});
}

}  // namespace vrc
