// SPDX-License-Identifier: GPL-3.0-or-later
// Figures about the glossy-glossy term and derivatives.
#include "figure_parts.h"

namespace vrc {
namespace {

/// The panels of a group that shows one quantity by several methods.
FigureGroup derivative_group(const std::string& name, const std::string& scene, const std::string& quantity,
                             const std::string& prefix, const std::string& words,
                             const std::vector<std::string>& methods) {
  FigureGroup group{name, scene, words, quantity};
  for (const std::string& method : methods) {
    FigurePanel panel;
    panel.id = prefix + method + "_" + quantity;
    panel.name = method == "finite-differences" ? "Reference: finite differences"
                 : method == "analytic"         ? "Analytic"
                 : method == "no-glossy-glossy" ? "Without the glossy-glossy term"
                 : method == "difference"       ? "The glossy-glossy term"
                                                : "Spherical harmonics";
    panel.kind = PanelKind::kDerivatives;
    panel.method = method;
    if (method != "finite-differences" && method != "difference")
      panel.reference = prefix + "finite-differences_" + quantity;
    group.panels.push_back(panel);
  }
  return group;
}

std::string derivative_words(int side, int rays, int reference_rays) {
  return "--bounces 1 --size " + std::to_string(side) + "x" + std::to_string(side) + " --gather-rays " +
         std::to_string(rays) + " --reference-rays " + std::to_string(reference_rays) + " --sh-order 10";
}

/// Krivanek's method, and the paper's without and with the glossy-glossy term.
std::vector<FigurePanel> term_panels(const std::string& prefix, const std::string& records,
                                     const FigurePanel& reference, const NamedNumbers& without,
                                     const NamedNumbers& with) {
  return {
      reference,
      {prefix + "standard", "Radiance caching of Krivanek, harmonics of order 10",
       "--baseline krivanek --sh-order 10 " + records, reference.id},
      {prefix + "without", "Without the glossy-glossy term", "--preset paper --no-glossy-glossy " + records,
       reference.id, without},
      {prefix + "with", "With the glossy-glossy term", "--preset paper " + records, reference.id, with},
  };
}

}  // namespace

Figure figure_3(FigureSize size) {
  Figure figure;
  figure.title = "The glossy-glossy term in a Cornell box";
  figure.claim =
      "Without the derivative of the light that glossy surfaces send, the same records give a larger error; "
      "the term costs about a tenth of the time.";
  const int side = pick(size, 160, 512);
  const std::string records = records_words(pick(size, 700, 4000), 8192);
  FigureGroup group{"cornell_glossy", "cornell_glossy.xml", indirect_words(side, side) + " --exposure 1.5"};
  group.panels = term_panels("", records, reference_panel("reference", size),
                             {{"records", 4000}, {"seconds", 333}}, {{"records", 4000}, {"seconds", 376}});
  group.panels.push_back({"ours", "This program's defaults", records, "reference"});
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, without the term over with it", "without", "with", "relmse", at_least(1.3)),
      ratio_measure("relMSE, Krivanek over with the term", "standard", "with", "relmse", at_least(3.0)),
      ratio_measure("CPU time, with the term over without", "with", "without", "cpu_seconds", {},
                    376.0 / 333.0),
      ratio_measure("relMSE, with the term over defaults", "with", "ours", "relmse", {}),
  };
  return figure;
}

Figure figure_4(FigureSize size) {
  Figure figure;
  figure.title = "The glossy-glossy term of two planes";
  figure.claim =
      "Where a glossy floor reflects a glossy wall, records without the glossy-glossy term fail; where the "
      "wall is diffuse, both give about the same.";
  const int side = pick(size, 128, 512);
  const std::string records = records_words(pick(size, 300, 1000), pick(size, 4096, 8192));
  const std::string derivatives =
      derivative_words(pick(size, 32, 128), pick(size, 4096, 8192), pick(size, 2048, 32768));
  FigureGroup glossy{"glossy wall", "glossy_pair.xml", indirect_words(side, side) + " --exposure -1.5"};
  glossy.panels = term_panels("glossy_", records, reference_panel("glossy_reference", size), {}, {});
  FigureGroup diffuse{"diffuse wall", "glossy_pair_diffuse.xml", indirect_words(side, side)};
  diffuse.panels = term_panels("diffuse_", records, reference_panel("diffuse_reference", size), {}, {});
  figure.groups = {glossy,
                   derivative_group("gradient, glossy wall", "glossy_pair.xml", "gradient", "", derivatives,
                                    {"analytic", "no-glossy-glossy", "difference"}),
                   diffuse};
  for (FigurePanel& panel : figure.groups[1].panels) panel.reference.clear();
  figure.measures = {
      ratio_measure("glossy wall: relMSE, without the term over with it", "glossy_without", "glossy_with",
                    "relmse", at_least(10.0)),
      ratio_measure("glossy wall: relMSE, Krivanek over with the term", "glossy_standard", "glossy_with",
                    "relmse", at_least(10.0)),
      ratio_measure("diffuse wall: relMSE, without the term over with it", "diffuse_without", "diffuse_with",
                    "relmse", at_most(1.5)),
  };
  return figure;
}

Figure figure_5(FigureSize size) {
  Figure figure;
  figure.title = "Gradient and Hessian of the radiance towards the camera";
  figure.claim =
      "Analytic derivatives agree with finite differences; those without the glossy-glossy term, and those "
      "of spherical harmonics of order 10, do not.";
  const std::string words = derivative_words(pick(size, 32, 128), 8192, pick(size, 4096, 32768));
  const std::vector<std::string> methods = {"finite-differences", "analytic", "no-glossy-glossy", "sh"};
  for (const std::string scene : {"glossy_pair", "half_box"}) {
    for (const std::string quantity : {"gradient", "hessian"}) {
      const std::string name = scene + ": " + quantity, prefix = scene + "_";
      figure.groups.push_back(derivative_group(name, scene + ".xml", quantity, prefix, words, methods));
      const std::string analytic = prefix + "analytic_" + quantity;
      // In the half box, finite differences of second order are noise beside the creases.
      const bool clean = scene == "glossy_pair";
      figure.measures.push_back(
          panel_measure(name + ": relative RMS error, analytic", analytic, "relative_rms",
                        clean ? std::optional(at_most(quantity == "gradient" ? 0.1 : 0.2)) : std::nullopt));
      for (const std::string method : {"no-glossy-glossy", "sh"}) {
        figure.measures.push_back(ratio_measure(name + ": error, " + method + " over analytic",
                                                prefix + method + "_" + quantity, analytic, "relative_rms",
                                                at_least(clean ? 10.0 : 1.5)));
      }
    }
  }
  return figure;
}

}  // namespace vrc
