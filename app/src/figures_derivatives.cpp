// SPDX-License-Identifier: GPL-3.0-or-later
// Figures about the glossy-glossy term and derivatives.
#include <fmt/format.h>

#include "figure_curves.h"
#include "figure_parts.h"

namespace vrc {
namespace {

/// The panels of a group that shows one quantity by several methods.
FigureGroup derivative_group(const std::string& name, const std::string& scene, const std::string& quantity,
                             const std::string& prefix, const std::string& words,
                             const std::vector<std::string>& methods) {
  FigureGroup group{name, scene, "", quantity};
  for (const std::string& method : methods) {
    FigurePanel panel;
    panel.id = prefix + method + "_" + quantity;
    panel.name = method == "finite-differences" ? "Reference: finite differences"
                 : method == "analytic"         ? "Analytic"
                 : method == "no-glossy-glossy" ? "Without the glossy-glossy term"
                 : method == "difference"       ? "The glossy-glossy term"
                                                : "Spherical harmonics";
    panel.words = words;
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

/// Of those panels, by their records.
std::vector<FigureSeries> term_series(const std::string& prefix, int records) {
  return {records_series(prefix + "standard", records), records_series(prefix + "without", records),
          records_series(prefix + "with", records)};
}

/// Errors of the group that was added last over the rays of a gather: only those of the analytic derivatives
/// are noise.
void add_rays_curves(Figure& figure, const std::string& prefix, const std::string& quantity, int rays) {
  FigureGroup& group = figure.groups.back();
  FigureCurves curves{prefix + quantity,
                      quantity == "hessian" ? "Glossy pair: Hessian" : "Glossy pair: gradient",
                      {},
                      {"gather_rays"},
                      "relative_rms"};
  for (const std::string method : {"analytic", "no-glossy-glossy", "sh"}) {
    const FigureSeries series = rays_series(prefix + method + "_" + quantity, rays);
    curves.series.push_back(series);
    if (method == "analytic") {
      figure.measures.push_back(
          falling_measure(group.name + ": error along its curve, largest step, analytic", series,
                          "relative_rms", at_most(1.0)));
    } else {
      figure.measures.push_back(ratio_measure(group.name + ": error, all rays over an eighth, " + method,
                                              series.panel, points_of(series).front(), "relative_rms",
                                              at_least(0.8)));
    }
  }
  group.curves = {curves};
}

}  // namespace

Figure figure_3(FigureSize size) {
  Figure figure;
  figure.title = "The glossy-glossy term in a Cornell box";
  figure.claim =
      "Without the derivative of the light that glossy surfaces send, the same records give a larger error; "
      "the term costs about a tenth of the time.";
  const int side = pick(size, 160, 512);
  const int count = pick(size, 700, 4000), rays = 8192;
  const std::string records = records_words(count, rays);
  FigureGroup group{"cornell_glossy", "cornell_glossy.xml", indirect_words(side, side) + " --exposure 1.5"};
  group.panels = term_panels("", records, reference_panel("reference", size),
                             {{"records", 4000}, {"seconds", 333}}, {{"records", 4000}, {"seconds", 376}});
  group.panels.push_back({"ours", "This program's defaults", records, "reference"});
  FigureCurves by_rays{
      "rays_curve", fmt::format("Glossy Cornell box, {} records", count), {}, {"gather_rays"}};
  for (const char* panel : {"standard", "without", "with", "ours"})
    by_rays.series.push_back(rays_series(panel, rays));
  FigureCurves by_records{"records_curve",
                          fmt::format("Glossy Cornell box, {} rays a record", rays),
                          term_series("", count),
                          {"records", "cpu_seconds"}};
  by_records.series.push_back(records_series("ours", count));
  group.curves = {by_rays, by_records};
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, without the term over with it", "without", "with", "relmse", at_least(1.3)),
      ratio_measure("relMSE, Krivanek over with the term", "standard", "with", "relmse", at_least(3.0)),
      ratio_measure("relMSE, with the term, an eighth of the rays over all",
                    points_of(rays_series("with", rays)).front(), "with", "relmse", at_least(2.0)),
      falling_measure("with the term: relMSE along its curve of records, largest step",
                      records_series("with", count), "relmse", at_most(1.0)),
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
  const int count = pick(size, 300, 1000), rays = pick(size, 4096, 8192);
  const std::string records = records_words(count, rays);
  const std::string derivatives =
      derivative_words(pick(size, 32, 128), pick(size, 4096, 8192), pick(size, 2048, 32768));
  FigureGroup glossy{"glossy wall", "glossy_pair.xml", indirect_words(side, side) + " --exposure -1.5"};
  glossy.panels = term_panels("glossy_", records, reference_panel("glossy_reference", size), {}, {});
  FigureGroup diffuse{"diffuse wall", "glossy_pair_diffuse.xml", indirect_words(side, side)};
  diffuse.panels = term_panels("diffuse_", records, reference_panel("diffuse_reference", size), {}, {});
  const std::vector<FigureSeries> glossy_series = term_series("glossy_", count);
  glossy.curves = {{"glossy_curve", "Two planes, glossy wall", glossy_series, {"records"}}};
  diffuse.curves = {
      {"diffuse_curve", "Two planes, diffuse wall", term_series("diffuse_", count), {"records"}}};
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
      falling_measure("glossy wall: relMSE along its curve, largest step, with the term", glossy_series[2],
                      "relmse", at_most(1.0)),
      above_measure("glossy wall: relMSE along the curves, smallest ratio, without the term over with it",
                    glossy_series[1], glossy_series[2], "relmse", at_least(1.0)),
  };
  return figure;
}

Figure figure_5(FigureSize size) {
  Figure figure;
  figure.title = "Gradient and Hessian of the radiance towards the camera";
  figure.claim =
      "Analytic derivatives agree with finite differences; those without the glossy-glossy term, and those "
      "of spherical harmonics of order 10, do not.";
  const int rays = 8192;
  const std::string words = derivative_words(pick(size, 32, 128), rays, pick(size, 4096, 32768));
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
      if (clean) add_rays_curves(figure, prefix, quantity, rays);
    }
  }
  return figure;
}

}  // namespace vrc
