// SPDX-License-Identifier: GPL-3.0-or-later
// Figures that compare radiance with spherical harmonics.
#include "figure_curves.h"
#include "figure_parts.h"

namespace vrc {

Figure figure_2(FigureSize size) {
  Figure figure;
  figure.title = "Interpolated radiance against spherical harmonics";
  figure.claim =
      "At exponent 100, spherical harmonics of order 10 ring, however many records there are; interpolated "
      "radiance does not.";
  const int side = pick(size, 160, 512);
  const int count = pick(size, 800, 8000);
  const std::string records = records_words(count, pick(size, 4096, 8192));
  FigureGroup group{"half_box", "half_box.xml", indirect_words(side, side)};
  group.panels = {
      reference_panel("reference", size),
      {"analytic",
       "Radiance",
       "--preset paper --representation analytic " + records,
       "reference",
       {{"records", 8000}}},
      {"harmonics",
       "Spherical harmonics of order 10",
       "--preset paper --representation sh --sh-order 10 " + records,
       "reference",
       {{"records", 8000}}},
      {"ours", "This program's defaults", records, "reference"},
  };
  const FigureSeries radiance = records_series("analytic", count);
  group.curves = {{"curve",
                   "Half box at exponent 100",
                   {radiance, records_series("harmonics", count), records_series("ours", count)},
                   {"records", "cpu_seconds"}}};
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, harmonics over radiance", "harmonics", "analytic", "relmse", at_least(10.0)),
      ratio_measure("relMSE, harmonics over radiance with a quarter of the records", "harmonics",
                    points_of(radiance).front(), "relmse", at_least(3.0)),
      ratio_measure("relMSE, radiance with a quarter of the records over all", points_of(radiance).front(),
                    "analytic", "relmse", at_least(1.5)),
      ratio_measure("relMSE, radiance over defaults", "analytic", "ours", "relmse", {}),
  };
  return figure;
}

Figure figure_7(FigureSize size) {
  Figure figure;
  figure.title = "Equal time: radiance, spherical harmonics, path tracing";
  figure.claim =
      "In the time of 5000 records of radiance, spherical harmonics and path tracing leave larger errors; "
      "making the records before shading (the overture) helps harmonics more than radiance.";
  const int side = pick(size, 160, 512), count = pick(size, 1200, 5000);
  const std::string rays = " --gather-rays 8192";
  const std::string radiance = "--preset paper" + rays;
  const std::string harmonics = "--preset paper --representation sh --sh-order 10" + rays;
  const NamedNumbers paper = {{"records", 5000}, {"gather_rays", 8192}, {"seconds", 200}};
  const NamedNumbers paper_harmonics = {{"records", 800}, {"gather_rays", 8192}, {"seconds", 200}};
  FigureGroup group{"cornell_glossy", "cornell_glossy.xml", indirect_words(side, side) + " --exposure 1.5"};
  group.panels = {
      reference_panel("reference", size),
      {"analytic", "Radiance, overture", radiance + " --records " + std::to_string(count), "reference",
       paper},
      {"analytic_single", "Radiance, no overture", radiance + " --overture off", "reference", paper,
       EqualTime{"analytic", "--records", count}},
      {"harmonics", "Spherical harmonics, overture", harmonics, "reference", paper_harmonics,
       EqualTime{"analytic", "--records", count / 2}},
      {"harmonics_single", "Spherical harmonics, no overture", harmonics + " --overture off", "reference",
       paper_harmonics, EqualTime{"analytic", "--records", count / 2}},
      {"path",
       "Path tracing",
       "--method path",
       "reference",
       {{"seconds", 200}},
       EqualTime{"analytic", "--spp", 16}},
      {"ours",
       "This program's defaults",
       rays.substr(1),
       "reference",
       {},
       EqualTime{"analytic", "--records", count}},
  };
  const FigureSeries by_records = records_series("analytic", count);
  const FigureSeries by_samples = samples_series("path");
  group.curves = {
      {"curve",
       "Glossy Cornell box, 8192 rays a record",
       {by_records, records_series("harmonics", count / 2), records_series("ours", count / 2), by_samples},
       {"cpu_seconds", "records", "rays"}}};
  figure.groups = {group};
  figure.measures = {
      ratio_measure("relMSE, harmonics over radiance, overture", "harmonics", "analytic", "relmse",
                    at_least(2.0), 2.0),
      ratio_measure("relMSE, harmonics over radiance, no overture", "harmonics_single", "analytic_single",
                    "relmse", at_least(2.0)),
      ratio_measure("relMSE, path tracing over radiance", "path", "analytic", "relmse", at_least(5.0)),
      ratio_measure("relMSE, harmonics without over with overture", "harmonics_single", "harmonics", "relmse",
                    at_least(1.0), 1.0 / 0.7),
      ratio_measure("relMSE, radiance without over with overture", "analytic_single", "analytic", "relmse",
                    {}),
      ratio_measure("relMSE, radiance over defaults", "analytic", "ours", "relmse", {}),
      ratio_measure("CPU time, harmonics over radiance", "harmonics", "analytic", "cpu_seconds", {}),
      ratio_measure("records, radiance over harmonics", "analytic", "harmonics", "records", {},
                    5000.0 / 800.0),
      falling_measure("radiance: relMSE along its curve, largest step", by_records, "relmse", at_most(1.0)),
      falling_measure("path tracing: relMSE along its curve, largest step", by_samples, "relmse",
                      at_most(1.0)),
  };
  return figure;
}

Figure figure_11(FigureSize size) {
  Figure figure;
  figure.title = "Metal pots: curved surfaces";
  figure.claim =
      "At one threshold, spherical harmonics where normals turn (the paper's hybrid) need fewer records than "
      "flat records of radiance alone for about the same error; this program's records, which know how "
      "surfaces bend, have a lower error than both.";
  const int width = pick(size, 128, 640), height = pick(size, 96, 480);
  // The close-up of the saucepan. Edges get more samples everywhere: they are not what is compared.
  FigureGroup group{"pots", "pots.xml",
                    indirect_words(width, height) + " -D target=0.3,0.1,0.1 -D fov=15 --gather-rays " +
                        std::to_string(pick(size, 2048, 8192)) + " --exposure 1 --error " +
                        pick(size, "0.1", "0.03")};
  const std::string paper = "--preset paper --supersample-edges on";
  group.panels = {
      reference_panel("reference", size),
      {"flat", "Radiance alone", paper + " --representation analytic", "reference"},
      {"hybrid", "The paper's hybrid", paper, "reference"},
      {"ours", "This program's defaults", "", "reference"},
  };
  figure.groups = {group};
  figure.measures = {
      ratio_measure("records, radiance alone over hybrid", "flat", "hybrid", "records", at_least(1.4)),
      ratio_measure("relMSE, hybrid over radiance alone", "hybrid", "flat", "relmse", at_most(1.4)),
      ratio_measure("relMSE, hybrid over defaults", "hybrid", "ours", "relmse", at_least(1.2)),
      ratio_measure("relMSE, radiance alone over defaults", "flat", "ours", "relmse", at_least(1.2)),
  };
  return figure;
}

}  // namespace vrc
