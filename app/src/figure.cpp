// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "core/error.h"
#include "figure_parts.h"

namespace vrc {

double number_of(const NamedNumbers& numbers, std::string_view name) {
  const auto found = std::ranges::find(numbers, name, &NamedNumbers::value_type::first);
  if (found == numbers.end()) throw InputError(fmt::format("a panel has no number '{}'", name));
  return found->second;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

Figure figure_of_paper(int number, FigureSize size) {
  constexpr std::array kFigures = {figure_1, figure_2, figure_3, figure_4,  figure_5,  figure_6,
                                   figure_7, figure_8, figure_9, figure_10, figure_11, figure_12};
  static_assert(kFigures.size() == kLastFigure - kFirstFigure + 1);
  VRC_CHECK(number >= kFirstFigure && number <= kLastFigure, "figure {}", number);
  Figure figure = kFigures[static_cast<std::size_t>(number - kFirstFigure)](size);
  figure.number = number;
  return figure;
}

}  // namespace vrc
