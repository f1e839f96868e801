// SPDX-License-Identifier: GPL-3.0-or-later
#include "display_arguments.h"

#include "cli_values.h"

namespace vrc {

void declare_display(CLI::App& command, Display& display, const std::string& what, const std::string& group) {
  const auto in_group = [&group](CLI::Option* option) {
    if (!group.empty()) option->group(group);
  };
  in_group(add_number(command, "--exposure", display.exposure, NumberRange<double>{-64.0, 64.0},
                      "Powers of two that " + what + " brightened by"));
  in_group(add_choice(
      command, "--tonemap", display.tonemap,
      {{"none", Tonemap::kNone}, {"reinhard", Tonemap::kReinhard}, {"aces", Tonemap::kAces}},
      "How " + what + " fitted to a screen: cut off at 1, by L / (1 + L), or by the ACES film curve"));
}

}  // namespace vrc
