// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "figure.h"

/// What the definitions of figures are made of.
namespace vrc {

template <typename T>
[[nodiscard]] T pick(FigureSize size, T quick, T full) {
  return size == FigureSize::kQuick ? quick : full;
}

/// Indirect light of one bounce in a picture of so many pixels, as all figures of the paper show.
[[nodiscard]] std::string indirect_words(int width, int height);

/// The picture that others are compared with; `rays` are guided ones of a pixel, of each half.
[[nodiscard]] FigurePanel reference_panel(std::string id, int spp, int rays);
[[nodiscard]] FigurePanel reference_panel(std::string id, FigureSize size);

/// Options of so many records and rays of each.
[[nodiscard]] std::string records_words(int records, int gather_rays);

/// The option and number with a bound or without.
[[nodiscard]] FigureMeasure ratio_measure(std::string name, const std::string& panel, const std::string& of,
                                          const std::string& number, std::optional<FigureBound> bound,
                                          std::optional<double> paper = {});
/// A number of one panel.
[[nodiscard]] FigureMeasure panel_measure(std::string name, const std::string& panel,
                                          const std::string& number, std::optional<FigureBound> bound,
                                          std::optional<double> paper = {});

/// The largest ratio of a number from point to point of the series: below 1, it falls along all of them.
[[nodiscard]] FigureMeasure falling_measure(std::string name, const FigureSeries& series,
                                            const std::string& number, std::optional<FigureBound> bound);

/// The smallest ratio of a number between two series' points of the same places in them: above 1, it is
/// larger along all of the first one.
[[nodiscard]] FigureMeasure above_measure(std::string name, const FigureSeries& upper,
                                          const FigureSeries& lower, const std::string& number,
                                          std::optional<FigureBound> bound);

/// By --gather-rays, doubling from an eighth of `most`.
[[nodiscard]] FigureSeries rays_series(const std::string& panel, int most);

/// By --spp, from 16 to 64, of a panel that takes more.
[[nodiscard]] FigureSeries samples_series(const std::string& panel);

/// By --records, from a quarter up to `most` of them.
[[nodiscard]] FigureSeries records_series(const std::string& panel, int most);

[[nodiscard]] constexpr FigureBound at_least(double limit) { return {true, limit}; }
[[nodiscard]] constexpr FigureBound at_most(double limit) { return {false, limit}; }

[[nodiscard]] Figure figure_1(FigureSize size);
[[nodiscard]] Figure figure_2(FigureSize size);
[[nodiscard]] Figure figure_3(FigureSize size);
[[nodiscard]] Figure figure_4(FigureSize size);
[[nodiscard]] Figure figure_5(FigureSize size);
[[nodiscard]] Figure figure_6(FigureSize size);
[[nodiscard]] Figure figure_7(FigureSize size);
[[nodiscard]] Figure figure_8(FigureSize size);
[[nodiscard]] Figure figure_9(FigureSize size);
[[nodiscard]] Figure figure_10(FigureSize size);
[[nodiscard]] Figure figure_11(FigureSize size);
[[nodiscard]] Figure figure_12(FigureSize size);

}  // namespace vrc
