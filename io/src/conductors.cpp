// SPDX-License-Identifier: GPL-3.0-or-later
#include "conductors.h"

#include <array>

namespace vrc {
namespace {

// Measured spectra averaged to linear sRGB, four digits.
constexpr std::array<Conductor, 5> kConductors = {{
    {"Ag", {0.1553f, 0.1167f, 0.1384f}, {4.828f, 3.122f, 2.147f}},
    {"Al", {1.657f, 0.8804f, 0.5212f}, {9.224f, 6.270f, 4.837f}},
    {"Au", {0.1431f, 0.3750f, 1.442f}, {3.983f, 2.386f, 1.603f}},
    {"Cr", {4.370f, 2.917f, 1.655f}, {5.206f, 4.231f, 3.755f}},
    {"Cu", {0.2004f, 0.9240f, 1.102f}, {3.913f, 2.453f, 2.142f}},
}};

}  // namespace

std::optional<Conductor> find_conductor(std::string_view name) {
  for (const Conductor& conductor : kConductors) {
    if (conductor.name == name) return conductor;
  }
  return std::nullopt;
}

std::string conductor_names() {
  std::string names;
  for (const Conductor& conductor : kConductors) {
    if (!names.empty()) names += ", ";
    names += conductor.name;
  }
  return names;
}

}  // namespace vrc
